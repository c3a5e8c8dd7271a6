// SPDX-License-Identifier: BSD-3-Clause
// theme.js -- light or dark: as the system prefers, until it is chosen.

const prefersDark = matchMedia('(prefers-color-scheme: dark)');

export const isDark = () => (document.documentElement.dataset.theme ?? (prefersDark.matches ? 'dark' : 'light')) === 'dark';

export function toggleTheme() {
    document.documentElement.dataset.theme = isDark() ? 'light' : 'dark';
}

/** Calls `apply` when the system's preference changes. */
export const onPreference = (apply) => prefersDark.addEventListener('change', apply);
