/* SPDX-License-Identifier: BSD-3-Clause */
/* sundials_export.h -- what SUNDIALS' CMake would write: nothing is exported. */
#define SUNDIALS_EXPORT
#define SUNDIALS_NO_EXPORT
#define SUNDIALS_DEPRECATED_EXPORT __attribute__((__deprecated__))
