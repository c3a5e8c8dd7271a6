/* SPDX-License-Identifier: BSD-3-Clause */
/* The built player as a string of the program: page.h. */
    .section .rodata
    .global weft__player_page
    .hidden weft__player_page
weft__player_page:
    .incbin "viewer/dist/player.html"
    .byte 0
    .section .note.GNU-stack, "", %progbits
