/* SPDX-License-Identifier: BSD-3-Clause */
/* page.h -- data inside an HTML page: JSON that cannot end its element, and numbers as
 * base64. */
#ifndef WEFT_RECORD_PAGE_H
#define WEFT_RECORD_PAGE_H

#include <stddef.h>
#include <stdio.h>

#include "record/record.h"

/* The player and the diagram of weft compare as built from viewer/: strings with
 * PAGE_MARK in the place of the data, in pages.c, which the Makefile writes. */
extern const char weft__player_page[], weft__compare_page[];
/* In pages.c too: scenes/hammock.yaml. */
extern const char weft__hammock_page[];
#define PAGE_MARK "<!--WEFT-DATA-->"

/* One of them up to the mark, and from there on. `live`: it may ask the server it came
 * from for more. */
void page_begin(FILE *stream, const char *page, bool live);
void page_end(FILE *stream, const char *page);
/* The player's page as a file at `path`; page_commit completes it unless
 * `written` is an error, which it returns. */
weft_status page_open(record_file *file, const char *path, weft_error *err);
weft_status page_commit(record_file *file, weft_status written, weft_error *err);

/* A JSON string in which <, > and & are escaped too. */
void page_text(FILE *stream, const char *text);
/* The same without the quotes around it. */
void page_characters(FILE *stream, const char *text);
/* The last part of a path as such a string: the page does not reveal where on its
 * author's disk the run is. */
void page_directory(FILE *stream, const char *path);
/* All of directory/name as such a string, or null if it cannot be opened. */
void page_file(FILE *stream, const char *directory, const char *name);
/* Bytes as base64, and that in a <script type="weft/frame">. */
void page_base64(FILE *stream, const unsigned char *bytes, size_t size);
void page_bytes(FILE *stream, const unsigned char *bytes, size_t size);

/* A block holds planes of `count` numbers each: first the smallest and largest number
 * of each plane as two floats, then, plane after plane, 16 bits per number that divide
 * the range between them evenly. Little-endian. */
size_t page_block_size(size_t planes, size_t count);
void page_plane(unsigned char *block, size_t planes, size_t plane, const double *values,
                size_t count);

#endif
