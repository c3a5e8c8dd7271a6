// SPDX-License-Identifier: BSD-3-Clause
// tip.js -- a few words beside the pointer.

/** Moves it there, within the window. */
export function placeTip(tip, event) {
    const { width, height } = tip.getBoundingClientRect();
    tip.style.left = `${Math.max(8, Math.min(event.clientX + 14, innerWidth - width - 8))}px`;
    tip.style.top = `${event.clientY + 18 + height > innerHeight ? event.clientY - height - 12 : event.clientY + 18}px`;
}
