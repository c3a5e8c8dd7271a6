/* SPDX-License-Identifier: BSD-3-Clause */
/* The built pages as strings of the program: page.h. */
    .section .rodata
    .global weft__player_page
    .hidden weft__player_page
weft__player_page:
    .incbin "viewer/dist/player.html"
    .byte 0
    .global weft__compare_page
    .hidden weft__compare_page
weft__compare_page:
    .incbin "viewer/dist/compare.html"
    .byte 0
    .section .note.GNU-stack, "", %progbits
