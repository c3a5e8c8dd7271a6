/* SPDX-License-Identifier: BSD-3-Clause */
/* replay.c -- a target of tests/fuzz with the files that are named, where libFuzzer is
 * not linked: what it once found, in every build with sanitizers. */
#include "fuzz/fuzz.h"

#include <stdio.h>

int main(int argc, char **argv)
{
    HOLDS(argc > 1);
    for (int i = 1; i < argc; ++i) {
        FILE *stream = fopen(argv[i], "rb");
        HOLDS(stream != NULL && fseek(stream, 0, SEEK_END) == 0);
        const size_t size = (size_t)ftell(stream);
        rewind(stream);
        /* no byte more, so that reading one is found */
        uint8_t *data = malloc(size + (size == 0));
        HOLDS(data != NULL && fread(data, 1, size, stream) == size
              && fclose(stream) == 0);
        (void)LLVMFuzzerTestOneInput(data, size);
        free(data);
    }
    (void)printf("%s: %d inputs\n", argv[0], argc - 1);
    return 0;
}
