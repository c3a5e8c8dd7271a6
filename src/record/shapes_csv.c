/* SPDX-License-Identifier: BSD-3-Clause */
/* shapes_csv.c -- shapes.csv: one row per frame and shape, with the force and the
 * torque that the cloth exerts on it. The cell of a NaN is empty, as in series.csv. */
#include "record/series.h"

#include <math.h>

weft_status record_shapes_open(record_table *table, const char *directory,
                               const weft_cloth *cloth, bool again, weft_error *err)
{
    if (weft_cloth_shapes(cloth) == 0) {
        return WEFT_OK;
    }
    const weft_status status
        = record_table_open(table, directory, "shapes.csv", again, err);
    return status != WEFT_OK || again
               ? status
               : record_table_write(table, "frame,time,shape,fx,fy,fz,tx,ty,tz\n", err);
}

static weft_status add_row(record_table *table, const record_frame *frame, size_t k,
                           weft_error *err)
{
    char line[256]; /* a number has at most 24 characters */
    double load[6];
    const double t = weft_sim_time(frame->sim);
    weft_sim_shape_load(frame->sim, k, load, load + 3);
    if (table->stream == NULL) { /* a band that does not write */
        return WEFT_OK;
    }
    size_t used
        = (size_t)snprintf(line, sizeof line, "%zu,%.17g,%zu", frame->index, t, k);
    for (size_t i = 0; i < 6; ++i) {
        used += (size_t)snprintf(line + used, sizeof line - used,
                                 isnan(load[i]) ? "," : ",%.17g", load[i]);
    }
    line[used] = '\n';
    line[used + 1] = '\0';
    return record_table_write(table, line, err);
}

weft_status record_shapes_add(record_table *table, const record_frame *frame,
                              weft_error *err)
{
    const size_t count = weft_cloth_shapes(weft_sim_cloth(frame->sim));
    weft_status status = WEFT_OK;
    for (size_t k = 0; status == WEFT_OK && k < count; ++k) {
        status = add_row(table, frame, k, err);
    }
    return status;
}
