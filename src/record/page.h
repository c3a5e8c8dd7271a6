/* SPDX-License-Identifier: BSD-3-Clause */
/* page.h -- data inside an HTML page: JSON that cannot leave its element, and planes of
 * numbers as base64. */
#ifndef WEFT_RECORD_PAGE_H
#define WEFT_RECORD_PAGE_H

#include <stddef.h>
#include <stdio.h>

/* The player and the diagram of weft compare as built from viewer/: strings that have
 * PAGE_MARK where data belong, in pages.c, which the Makefile writes. */
extern const char weft__player_page[], weft__compare_page[];
#define PAGE_MARK "<!--WEFT-DATA-->"

/* A JSON string in which <, > and & are escaped too. */
void page_text(FILE *stream, const char *text);
/* All of directory/name as such a string, or null if it cannot be opened. */
void page_file(FILE *stream, const char *directory, const char *name);
/* Bytes as base64 in a <script type="weft/frame">. */
void page_bytes(FILE *stream, const unsigned char *bytes, size_t size);

/* A block holds planes of `count` numbers each: first their smallest and largest, two
 * floats a plane, then, plane after plane, 16 bits a number that divide the range
 * between these evenly. Little-endian. */
size_t page_block_size(size_t planes, size_t count);
void page_plane(unsigned char *block, size_t planes, size_t plane, const double *values,
                size_t count);

#endif
