/* SPDX-License-Identifier: BSD-3-Clause */
/* vtkhdf.c -- any bytes as run.vtkhdf. libhdf5 crashes on some, which is not for us to
 * mend: tools/checks/fuzz ignores a crash whose stack begins in there. */
#include "fuzz/frames.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_write("run.vtkhdf", data, size);
    frames_check();
    return 0;
}
