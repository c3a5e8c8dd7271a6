// SPDX-License-Identifier: BSD-3-Clause
// save.js -- a file that the reader gets from the page.

/** `parts`: texts or a Blob. */
export function save(name, type, ...parts) {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob(parts, { type }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);

/** Rows of cells as RFC 4180 has them; null and NaN are empty. */
export const csv = (rows) => rows.map(
    (row) => `${row.map((cell) => (cell === null || cell === undefined || Number.isNaN(cell) ? '' : quoted(String(cell)))).join(',')}\n`,
).join('');

/** A name for a file, of words. */
export const fileName = (text) => text.replace(/[^\w.-]+/g, '-').replace(/^[-.]+|-+$/g, '') || 'weft';
