/* SPDX-License-Identifier: BSD-3-Clause */
/* handler.c -- catches the signals of the program. */
#define ID    "handler"
#define ENTRY weft_plugin_handler
#include <signal.h>
#define ON_CREATE(self, config) ((void)(config), (void)signal(SIGFPE, SIG_IGN))
#include "working.c"
