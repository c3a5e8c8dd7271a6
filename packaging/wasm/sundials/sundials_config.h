/* SPDX-License-Identifier: BSD-3-Clause */
/* sundials_config.h -- what SUNDIALS' CMake would write: 6.4.1 with the options of
 * Debian's package, but for MPI. */
#pragma once

#include "sundials/sundials_export.h"

#define SUNDIALS_DEPRECATED_EXPORT_MSG(text) __attribute__((__deprecated__(text)))
#define SUNDIALS_VERSION                     "6.4.1"
#define SUNDIALS_VERSION_MAJOR               6
#define SUNDIALS_VERSION_MINOR               4
#define SUNDIALS_VERSION_PATCH               1
#define SUNDIALS_VERSION_LABEL               ""
#define SUNDIALS_C_COMPILER_HAS_MATH_PRECISIONS
#define SUNDIALS_C_COMPILER_HAS_ISINF_ISNAN
#define SUNDIALS_C_COMPILER_HAS_SNPRINTF_AND_VA_COPY
#define SUNDIALS_DOUBLE_PRECISION 1
#define SUNDIALS_INT64_T          1
#define SUNDIALS_INDEX_TYPE       int64_t
#define SUNDIALS_LOGGING_LEVEL    0
#define SUNDIALS_MPI_ENABLED      0
#define SUNDIALS_C_INLINE         inline
#define SUNDIALS_INLINE           inline
#define SUNDIALS_STATIC_INLINE    static inline
