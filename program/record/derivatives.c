/* SPDX-License-Identifier: BSD-3-Clause */
/* derivatives.c -- derivatives of a run with respect to parameters of its scene, as
 * files have them. */
#include <math.h>
#include <stdlib.h>

#include "program/record/record.h"

/* What s is divided by. */
static double unit_of(const weft_scene_sensitivity *of, size_t j)
{
    return of->relative || of->values[j] == 0.0 ? 1.0 : of->values[j];
}

void record_sensitivity(const weft_scene *scene, const weft_sim *sim, size_t j,
                        bool velocities, double *xyz)
{
    const weft_cloth *cloth = weft_sim_cloth(sim);
    const size_t n = weft_cloth_particles(cloth);
    const double unit = unit_of(weft_scene_sensitivities(scene), j);
    const double *s = weft_sim_sensitivity(sim, j) + (velocities ? 3 * n : 0);
    for (size_t i = 0; i < n; ++i) {
        const size_t at = weft_cloth_index(cloth, i);
        for (size_t k = 0; k < 3; ++k) {
            xyz[3 * i + k] = s[k * n + at] / unit;
        }
    }
}

double record_sensitivity_most(const weft_scene *scene, const weft_sim *sim, size_t j)
{
    const size_t n = weft_cloth_particles(weft_sim_cloth(sim));
    const double *s = weft_sim_sensitivity(sim, j);
    double most = 0.0;
    for (size_t i = 0; i < n; ++i) {
        const double x = s[i], y = s[n + i], z = s[2 * n + i];
        most = fmax(most, sqrt(x * x + y * y + z * z));
    }
    return most / fabs(unit_of(weft_scene_sensitivities(scene), j));
}

/* [m] The diagonal of the box about the cloth at rest. */
static double diagonal(const weft_cloth *cloth)
{
    const size_t n = weft_cloth_particles(cloth);
    double *xyz = malloc(3 * n * sizeof *xyz), square = 0.0;
    if (xyz == NULL) {
        return INFINITY;
    }
    weft_cloth_rest(cloth, xyz);
    for (size_t k = 0; k < 3; ++k) {
        double least = xyz[k], most = xyz[k];
        for (size_t i = 1; i < n; ++i) {
            least = fmin(least, xyz[3 * i + k]);
            most = fmax(most, xyz[3 * i + k]);
        }
        square += (most - least) * (most - least);
    }
    free(xyz);
    return sqrt(square);
}

double record_sensitivity_growth(const weft_scene *scene, const weft_sim *sim,
                                 size_t *parameter)
{
    const weft_scene_sensitivity *of = weft_scene_sensitivities(scene);
    double most = 0.0;
    for (size_t j = 0; j < of->count; ++j) {
        const double moved
            = 0.01 * fabs(unit_of(of, j)) * record_sensitivity_most(scene, sim, j);
        if (moved > most) {
            most = moved;
            if (parameter != NULL) {
                *parameter = j;
            }
        }
    }
    return most > 0.0 ? most / diagonal(weft_sim_cloth(sim)) : 0.0;
}

weft_status record_sensitivities(const char *directory, const weft_scene *scene,
                                 const weft_sim *sim, weft_error *err)
{
    const weft_scene_sensitivity *of = weft_scene_sensitivities(scene);
    const weft_cloth *cloth = weft_sim_cloth(sim);
    const size_t n = weft_cloth_particles(cloth), cols = weft_cloth_cols(cloth);
    const bool parts = weft_cloth_parts(cloth) > 0;
    record_file file;
    double *values = calloc(6 * n, sizeof *values);
    if (values == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for " RECORD_SENSITIVITY);
    }
    weft_status status = record_file_open(&file, directory, RECORD_SENSITIVITY, err);
    if (status == WEFT_OK) {
        fprintf(file.stream, "key,%s,x,y,z,vx,vy,vz\n",
                cols > 0 ? "row,col"
                : parts  ? "cloth,vertex"
                         : "vertex");
        for (size_t j = 0; j < of->count; ++j) {
            record_sensitivity(scene, sim, j, false, values);
            record_sensitivity(scene, sim, j, true, values + 3 * n);
            for (size_t i = 0; i < n; ++i) {
                fprintf(file.stream, "%s,", of->keys[j]);
                if (parts) {
                    fprintf(
                        file.stream, "%s,",
                        weft_cloth_part_at(cloth, weft_cloth_part_of(cloth, i)).name);
                }
                if (cols > 0) {
                    fprintf(file.stream, "%zu,%zu", i / cols, i % cols);
                } else {
                    fprintf(file.stream, "%zu", weft_cloth_file_index(cloth, i));
                }
                for (size_t k = 0; k < 6; ++k) {
                    fprintf(file.stream, ",%.17g",
                            values[k / 3 * 3 * n + 3 * i + k % 3]);
                }
                fputc('\n', file.stream);
            }
        }
        status = record_file_commit(&file, err);
    }
    free(values);
    return status;
}
