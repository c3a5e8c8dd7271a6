/* SPDX-License-Identifier: BSD-3-Clause */
/* vtkhdf.c -- any bytes as run.vtkhdf. libhdf5 crashes on some, which is not for us to
 * mend: tools/fuzz ignores a crash whose stack begins in there. */
#include "fuzz/frames.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    FILE *stream = fopen(frames_file(), "w");
    HOLDS(stream != NULL);
    HOLDS(fwrite(data, 1, size, stream) == size);
    HOLDS(fclose(stream) == 0);
    frames_check();
    return 0;
}
