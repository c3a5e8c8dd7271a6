/* SPDX-License-Identifier: BSD-3-Clause */
/* wind_keys.h -- the keys of forces.wind: a part of scene/keys.c, which has the macros.
 */

TABLE(wind, "s, m/s")

static const weft__key wind_keys[] = {
    { "velocity", WEFT__VECTOR, .absent = "required: velocity or table",
      NUMBER(wind, wind_velocity), .meaning = "velocity of the air" },
    { "table", WEFT__TRACK, SECTION(wind_table), .unit = "s, m/s",
      .absent = "required: velocity or table", AT(weft_cloth_def, wind_table),
      SPLINE(weft_cloth_def, wind_table),
      .meaning = "velocity at times: smooth, through all rows and between them within "
                 "their range, constant before the first and after the last; or {rows: "
                 "..., spline: natural}" },
    { "drag", WEFT__NUMBER, .required = true, NUMBER(wind, wind_drag),
      .meaning = "F = drag * area * (n . (velocity - v)) n" },
};
