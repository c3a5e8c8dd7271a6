/* SPDX-License-Identifier: BSD-3-Clause */
/* series.c -- the CSV files of a run. A column of series.csv is a name, a format and a
 * value; one list makes the header and the rows. The cell of a NaN is empty. */
#include "program/record/series.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/hash.h"

/* ---- tables ----------------------------------------------------------------- */

static weft_status write_line(record_table *table, const char *line, weft_error *err)
{
    for (const char *c = line; *c != '\0'; ++c, ++table->extent.length) {
        table->extent.sum = weft__hash_byte(table->extent.sum, (unsigned char)*c);
    }
    (void)fputs(line, table->stream);
    return !ferror(table->stream) && fflush(table->stream) == 0
               ? WEFT_OK
               : record_failed(table->path, err);
}

static weft_status open_table(record_table *table, const char *directory,
                              const char *name, bool again, weft_error *err)
{
    TRY(record_path(directory, name, table->path, err));
    TRY(record_no_link(table->path, err));
    table->extent = (record_extent){ .sum = WEFT__HASH_START };
    table->stream = weft__file_open(table->path, again ? "r+" : "w", err);
    return table->stream == NULL ? WEFT_IO : WEFT_OK;
}

weft_status record_table_cut(record_table *table, const record_extent *kept,
                             weft_error *err)
{
    table->extent = *kept;
    return table->stream == NULL
                   || (ftruncate(fileno(table->stream), (off_t)kept->length) == 0
                       && fseek(table->stream, 0, SEEK_END) == 0)
               ? WEFT_OK
               : record_failed(table->path, err);
}

weft_status record_table_sync(record_table *table, weft_error *err)
{
    if (table->stream == NULL) {
        return WEFT_OK;
    }
    TRY(write_line(table, "", err));
    return fsync(fileno(table->stream)) == 0 ? WEFT_OK
                                             : record_failed(table->path, err);
}

weft_status record_table_close(record_table *table, weft_error *err)
{
    if (table->stream == NULL) {
        return WEFT_OK;
    }
    const weft_status status = write_line(table, "", err);
    const bool closed = fclose(table->stream) == 0;
    table->stream = NULL;
    return closed || status != WEFT_OK ? status : record_failed(table->path, err);
}

/* ---- series.csv ------------------------------------------------------------- */

/* X(runs, name, format, value): the column is in every run, or only in those with that
 * RECORD_... option; `row` is the struct below. X_OF_LEDGER: that of a power. */
#define COLUMNS(X)                                                                     \
    X(EVERY, frame, "%zu", row.frame->index)                                           \
    X(EVERY, time, "%.17g", row.time)                                                  \
    X(EVERY, kinetic, "%.17g", row.all.energy.kinetic)                                 \
    X(EVERY, elastic, "%.17g", row.elastic)                                            \
    X(EVERY, gravitational, "%.17g", row.all.energy.gravitational)                     \
    X(EVERY, dissipated, "%.17g", row.dissipated)                                      \
    X(EVERY, momentum_x, "%.17g", row.all.momentum[0])                                 \
    X(EVERY, momentum_y, "%.17g", row.all.momentum[1])                                 \
    X(EVERY, momentum_z, "%.17g", row.all.momentum[2])                                 \
    X(EVERY, max_strain, "%.17g", row.all.worst.strain)                                \
    X(EVERY, steps, "%" PRIu64, row.stats.steps)                                       \
    X(EVERY, rejected, "%" PRIu64, row.stats.rejected)                                 \
    X(EVERY, rhs_calls, "%" PRIu64, row.stats.rhs_calls)                               \
    X(EVERY, step_size, "%.17g", row.stats.last_step)                                  \
    X(EVERY, limit_sweeps, "%" PRIu64, row.frame->limit_sweeps)                        \
    X(EVERY, hash, "%016" PRIx64, row.all.hash)                                        \
    X(EVERY, limit_strain, "%.17g", row.limit_strain)                                  \
    X(RECORD_LEDGER, elastic_stretch, "%.17g", row.all.energy.elastic[WEFT_STRETCH])   \
    X(RECORD_LEDGER, elastic_shear, "%.17g", row.all.energy.elastic[WEFT_SHEAR])       \
    X(RECORD_LEDGER, elastic_bend, "%.17g", row.all.energy.elastic[WEFT_BEND])         \
    WEFT_LEDGER_POWERS(X##_OF_LEDGER)                                                  \
    X(RECORD_LEDGER, work_limit, "%.17g", row.ledger.work_limit)                       \
    X(RECORD_LEDGER, residual, "%.17g", row.ledger.residual)                           \
    X(EVERY, contact, "%.17g", row.all.energy.contact)                                 \
    X(EVERY, min_gap, "%.17g", row.all.gap)                                            \
    X(EVERY, touching, "%zu", row.all.touching)                                        \
    X(EVERY, vetoed, "%" PRIu64, row.vetoed)                                           \
    WEFT_LEDGER_LATER_POWERS(X##_OF_LEDGER)                                            \
    X(RECORD_SOLVER, linear_iterations, "%" PRIu64, row.stats.linear_iterations)       \
    X(RECORD_SOLVER, factorisations, "%" PRIu64, row.stats.factorisations)             \
    X(RECORD_SOLVER, newton_failures, "%" PRIu64, row.stats.newton_failures)           \
    X(RECORD_SELF, self_gap, "%.17g", row.all.self_gap)                                \
    X(RECORD_SELF, self_touching, "%zu", row.all.self_touching)                        \
    X(RECORD_BETWEEN, interpolated, "%d", (int)weft_sim_is_between(row.frame->sim))

#define EVERY 0u

/* [bytes] A cell has at most 24 characters and a comma, and the name of a sensitivity
 * 112. */
enum { LINE = 64 * RECORD_COLUMNS_MAX };

typedef struct series_row {
    const record_frame *frame;
    double time, elastic, dissipated, limit_strain;
    weft_measures all;
    weft_ledger ledger;
    weft_stepper_stats stats;
    uint64_t vetoed;
} series_row;

static series_row measure(const record_frame *frame)
{
    const weft_sim *sim = frame->sim;
    series_row row = {
        .frame = frame,
        .time = weft_sim_time(sim),
        .all = weft_sim_measure(sim),
        .dissipated = weft_sim_dissipated(sim),
        .ledger = weft_sim_ledger(sim),
        .limit_strain = weft_sim_limit_worst(sim).strain,
        .stats = weft_sim_stats(sim),
        .vetoed = weft_sim_vetoed(sim),
    };
    for (size_t i = 0; i < WEFT_FAMILIES; ++i) {
        row.elastic += row.all.energy.elastic[i];
    }
    return row;
}

static bool has(const record_series *series, unsigned option)
{
    return option == EVERY || (series->optional & option) != 0;
}

size_t record_series_sensitivities(const record_series *series)
{
    return series->scene != NULL ? weft_scene_sensitivities(series->scene)->count : 0;
}

void record_series_begin(record_series *series, unsigned optional,
                         const weft_scene *scene)
{
    series->scene = scene;
    series->optional = optional;
    series->columns = 0;
#define NAME(runs, name, format, value)                                                \
    if (has(series, runs)) {                                                           \
        series->names[series->columns++] = #name;                                      \
    }
#define NAME_OF_LEDGER(member, power, by) NAME(RECORD_LEDGER, member, , )
    COLUMNS(NAME)
#undef NAME_OF_LEDGER
#undef NAME
    for (size_t j = 0; j < record_series_sensitivities(series); ++j) {
        (void)snprintf(series->own_names[j], RECORD_COLUMN_NAME, "sensitivity_%s",
                       weft_scene_sensitivities(series->scene)->keys[j]);
        series->names[series->columns++] = series->own_names[j];
    }
}

weft_status record_series_open(record_series *series, const char *directory,
                               unsigned optional, const weft_scene *scene, bool again,
                               weft_error *err)
{
    char line[LINE];
    size_t used = 0;
    record_series_begin(series, optional, scene);
    TRY(open_table(&series->table, directory, "series.csv", again, err));
    for (size_t i = 0; i < series->columns; ++i) {
        used
            += (size_t)snprintf(line + used, sizeof line - used, "%s%c",
                                series->names[i], i + 1 < series->columns ? ',' : '\n');
    }
    return again ? WEFT_OK : write_line(&series->table, line, err);
}

weft_status record_series_add(record_series *series, const record_frame *frame,
                              weft_error *err)
{
    const series_row row = measure(frame);
    char line[LINE];
    size_t column = 0, used = 0;
    series->worst = row.all.worst;
#define CELL(runs, name, format, value)                                                \
    if (has(series, runs)) {                                                           \
        used += (size_t)(isnan((double)(value))                                        \
                             ? snprintf(line + used, sizeof line - used, ",")          \
                             : snprintf(line + used, sizeof line - used, format ",",   \
                                        value));                                       \
        series->row[column++] = (double)(value);                                       \
    }
#define CELL_OF_LEDGER(member, power, by)                                              \
    CELL(RECORD_LEDGER, member, "%.17g", row.ledger.member)
    COLUMNS(CELL)
#undef CELL_OF_LEDGER
#undef CELL
    for (size_t j = 0; j < record_series_sensitivities(series); ++j) {
        const double most = record_sensitivity_most(series->scene, frame->sim, j);
        used += (size_t)snprintf(line + used, sizeof line - used, "%.17g,", most);
        series->row[column++] = most;
    }
    line[used - 1] = '\n';
    return series->table.stream == NULL ? WEFT_OK
                                        : write_line(&series->table, line, err);
}

/* ---- shapes.csv ------------------------------------------------------------- */

weft_status record_shapes_open(record_table *table, const char *directory,
                               const weft_cloth *cloth, bool again, weft_error *err)
{
    if (weft_cloth_shapes(cloth) == 0) {
        return WEFT_OK;
    }
    TRY(open_table(table, directory, "shapes.csv", again, err));
    return again ? WEFT_OK
                 : write_line(table, "frame,time,shape,fx,fy,fz,tx,ty,tz\n", err);
}

/* The force and the torque of the cloth on each shape. */
weft_status record_shapes_add(record_table *table, const record_frame *frame,
                              weft_error *err)
{
    const size_t count = weft_cloth_shapes(weft_sim_cloth(frame->sim));
    for (size_t k = 0; k < count; ++k) {
        char line[256]; /* a number has at most 24 characters */
        double load[6];
        weft_sim_shape_load(frame->sim, k, load, load + 3);
        size_t used = (size_t)snprintf(line, sizeof line, "%zu,%.17g,%zu", frame->index,
                                       weft_sim_time(frame->sim), k);
        for (size_t i = 0; i < 6; ++i) {
            used += (size_t)snprintf(line + used, sizeof line - used,
                                     isnan(load[i]) ? "," : ",%.17g", load[i]);
        }
        (void)snprintf(line + used, sizeof line - used, "\n");
        if (table->stream != NULL) { /* a band may not write */
            TRY(write_line(table, line, err));
        }
    }
    return WEFT_OK;
}
