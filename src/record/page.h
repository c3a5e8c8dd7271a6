/* SPDX-License-Identifier: BSD-3-Clause */
/* page.h -- data inside an HTML page: JSON that cannot end its element, and numbers as
 * base64. */
#ifndef WEFT_RECORD_PAGE_H
#define WEFT_RECORD_PAGE_H

#include <stddef.h>
#include <stdio.h>

/* The player and the diagram of weft compare as built from viewer/: strings with
 * PAGE_MARK in the place of the data, in pages.c, which the Makefile writes. */
extern const char weft__player_page[], weft__compare_page[];
#define PAGE_MARK "<!--WEFT-DATA-->"

/* A JSON string in which <, > and & are escaped too. */
void page_text(FILE *stream, const char *text);
/* All of directory/name as such a string, or null if it cannot be opened. */
void page_file(FILE *stream, const char *directory, const char *name);
/* Bytes as base64 in a <script type="weft/frame">. */
void page_bytes(FILE *stream, const unsigned char *bytes, size_t size);

/* A block holds planes of `count` numbers each: first the smallest and largest number
 * of each plane as two floats, then, plane after plane, 16 bits per number that divide
 * the range between them evenly. Little-endian. */
size_t page_block_size(size_t planes, size_t count);
void page_plane(unsigned char *block, size_t planes, size_t plane, const double *values,
                size_t count);

#endif
