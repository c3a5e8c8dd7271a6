/* SPDX-License-Identifier: BSD-3-Clause */
/* The program as its users meet it: exit codes, files, messages. */
#include <signal.h>
#include <unistd.h>

#include "shell.h"

#define OUT BUILD_DIR "/cli"

static void begin(void)
{
    (void)unsetenv("WEFT_PLUGIN_PATH");
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    write_file(OUT "/small.yaml", small_scene);
}

START_TEST(a_run_leaves_its_files)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/r 2>&1"), 0);
    says("done: small");
    ck_assert_str_eq(read_file(OUT "/r/scene.yaml"), small_scene);
    static const char header[]
        = "frame,time,kinetic,elastic,gravitational,dissipated,momentum_x,momentum_y,"
          "momentum_z,max_strain,steps,rejected,rhs_calls,step_size,limit_sweeps,hash,"
          "limit_strain,contact,min_gap,touching,vetoed\n0,0,";
    ck_assert_int_eq(strncmp(read_file(OUT "/r/series.csv"), header, strlen(header)),
                     0);
    expect(shell("wc -l < " OUT "/r/series.csv"), 0);
    ck_assert_int_eq(atoi(output), 12); /* header, frames 0 to 10 */
    expect(shell("grep -c ',0,inf,0,0$' " OUT "/r/series.csv"), 0); /* no shapes */
    ck_assert_int_eq(atoi(output), 11);
    ck_assert(!exists(OUT "/r/shapes.csv"));
    expect(shell("head -2 " OUT "/r/final.csv"), 0);
    says("row,col,x,y,z,vx,vy,vz\n0,0,0,0,0,0,0,0\n"); /* a pin at rest has not moved */
    expect(shell("cat " OUT "/r/result.yaml " OUT "/r/manifest.yaml"), 0);
    says("status: done\n");
    says("fixed_step: 0.001");
    says("name: \"velocity_verlet\"");
}
END_TEST

START_TEST(frames_are_at_exact_times_and_the_last_at_the_duration)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT
                      "/r --quiet --set run.fps=7 2>&1"),
           0);
    expect(shell("tail -n +2 " OUT "/r/series.csv | cut -d, -f2"), 0);
    const char *text = output;
    for (int i = 0; i <= 4; ++i) {
        char *end;
        const double t = strtod(text, &end);
        ck_assert(t == (i < 4 ? i / 7.0 : 0.5));
        text = end;
    }
}
END_TEST

START_TEST(the_same_scene_gives_the_same_bytes)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/a --quiet && " WEFT
                      " run " OUT "/small.yaml --out " OUT "/b --quiet && cmp " OUT
                      "/a/series.csv " OUT "/b/series.csv && cmp " OUT
                      "/a/final.csv " OUT "/b/final.csv && cmp " OUT
                      "/a/manifest.yaml " OUT "/b/manifest.yaml"),
           0);
}
END_TEST

START_TEST(a_run_can_be_repeated_from_the_scene_it_left)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT
                      "/a --quiet --set cloth.grid.rows=6 --set "
                      "'cloth.springs.bend={stiffness: 2}' 2>&1"),
           0);
    expect(shell(WEFT " run " OUT "/a/scene.yaml --out " OUT "/b --quiet 2>&1"), 0);
    expect(shell("cmp " OUT "/a/series.csv " OUT "/b/series.csv"), 0);
    expect(shell("wc -l < " OUT "/b/final.csv"), 0);
    ck_assert_int_eq(atoi(output), 31);
}
END_TEST

START_TEST(a_directory_that_is_not_empty_is_refused_unless_forced)
{
    expect(shell("mkdir -p " OUT "/r && echo mine > " OUT "/r/notes.txt"), 0);
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/r 2>&1"), 4);
    says("not empty");
    ck_assert(!exists(OUT "/r/result.yaml"));
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/r --force --quiet 2>&1"),
           0);
    ck_assert(exists(OUT "/r/result.yaml"));
    ck_assert_str_eq(read_file(OUT "/r/notes.txt"), "mine\n");
}
END_TEST

START_TEST(wrong_command_lines_exit_with_2)
{
    static const char *const wrong[] = {
        "",
        "fly",
        "run",
        "run a.yaml b.yaml",
        "run a.yaml --frames ply",
        "run a.yaml --speed 3",
        "run a.yaml --out",
        "check",
        "export",
        "export somewhere",
        "export somewhere --format stl",
        "steppers x",
        "scene-help x",
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        ck_assert_msg(shell(WEFT " %s 2>&1", wrong[i]) == 2, "weft %s: %s", wrong[i],
                      output);
        ck_assert_msg(output[0] != '\0', "weft %s says nothing", wrong[i]);
    }
}
END_TEST

/* As the name of a scene whose `name` is absent. */
START_TEST(a_new_scene_is_one_that_runs_and_replaces_no_file)
{
    expect(shell("cd " OUT " && ../weft new first && ../weft new second.yaml && "
                 "cmp first.yaml second.yaml && ../weft check first.yaml && ../weft "
                 "run first.yaml --set run.duration=0.1 --quiet"),
           0);
    says("first.yaml: ok: first\n");
    expect(shell("echo mine > " OUT "/first.yaml; " WEFT " new " OUT "/first 2>&1"), 4);
    says(OUT "/first.yaml: File exists\n");
    expect(shell("cat " OUT "/first.yaml; " WEFT " new " OUT "/none/first 2>&1"), 4);
    says("mine\n");
    says("none/first.yaml: No such file or directory\n");
}
END_TEST

/* A strip stretches by 490 N/m over C; the elastica of two bending lengths has 41.49
 * degrees. */
START_TEST(the_laboratory_measures_what_the_fabric_is)
{
    expect(shell("mkdir -p " OUT "/lab && cd " OUT
                 " && ../weft lab strip white-dots-on-blk"),
           0);
    says("EMT 12.2 % at 490 N/m, along the warp: a secant modulus of 4004 N/m");
    expect(shell("cd " OUT " && ../weft lab cantilever 11oz-black-denim"), 0);
    says("falls by 41.49 degrees");
    expect(shell("cd " OUT " && ../weft lab strip white-dots-on-blk --set "
                 "cloth.fabric.stretch=980"),
           0);
    says("EMT 50 % at 490 N/m");
    expect(shell("cd " OUT " && ../weft lab stripe x 2>&1"), 2);
    says("weft lab: TEST 'stripe' (did you mean 'strip'?) is not drape, cantilever or "
         "strip");
    expect(shell("cd " OUT " && ../weft lab strip denim 2>&1"), 2);
    says("FABRIC 'denim' (did you mean '11oz-black-denim'?) is not ");
    expect(shell("cd " OUT " && echo mine > lab/strip-royal-target.yaml && ../weft lab "
                 "strip royal-target --out lab 2>&1"),
           4);
    says("lab/strip-royal-target.yaml: File exists with another text; --force replaces "
         "it");
    expect(shell("cd " OUT " && cat lab/strip-royal-target.yaml && ../weft lab strip "
                 "royal-target --out lab --force"),
           0);
    says("mine\n");
    says("4033 N/m");
}
END_TEST

START_TEST(the_laboratory_writes_into_its_directory_alone)
{
    expect(shell("mkdir -p " OUT "/bench && cd " OUT
                 "/bench && ../../weft lab strip royal-target && ../../weft lab strip "
                 "royal-target --out a/b && find . -type f | sort"),
           0);
    says("  scene      a/b/strip-royal-target.yaml; 'weft run ");
    says("./a/b/strip-royal-target.yaml\n"
         "./strip-royal-target.lab/strip-royal-target.yaml\n");
    ck_assert_ptr_null(strstr(output, "\n./strip-royal-target.yaml"));
}
END_TEST

START_TEST(a_new_scene_has_a_name)
{
    static const char *const wrong[]
        = { "", ".", "..", "none/", "none/..", ".yaml", "none/.yaml" };
    expect(shell("mkdir -p " OUT "/new/none"), 0);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        expect(shell("cd " OUT "/new && ../../weft new '%s' 2>&1", wrong[i]), 2);
        char text[64];
        (void)snprintf(text, sizeof text, "weft new: '%s' names no file", wrong[i]);
        says(text);
    }
    expect(shell("find " OUT "/new -type f"), 0);
    ck_assert_str_eq(output, "");
    expect(shell("cd " OUT "/new && ../../weft new .mine"), 0);
    says(".mine.yaml: a hammock");
}
END_TEST

START_TEST(a_misspelt_word_of_the_command_line_is_told_with_the_one_that_is_near)
{
    static const char *const wrong[][2] = {
        { "rn", "no verb 'rn' (did you mean 'run'?)" },
        { "fly", "no verb 'fly'; 'weft --help' lists them" },
        { "run x --ot=y", "unknown option --ot=y (did you mean '--out'?)" },
        { "run x --ouput y", "unknown option --ouput (did you mean '--out'?)" },
        { "a/flag.yaml",
          "no verb 'a/flag.yaml' (did you mean 'weft run a/flag.yaml'?); 'weft" },
        { "version", "no verb 'version' (did you mean '--version'?)" },
        { "run x --frames ply", "--frames 'ply' is not obj\n" },
        { "run x --progress line", "--progress 'line' (did you mean 'lines'?) is not "
                                   "auto, lines, terminal, yaml "
                                   "or none" },
        { "resume x --progress foo", "--progress 'foo' is not auto, lines" },
        { "export x --format stl",
          "--format 'stl' is not obj, ply, csv, mdd, pc2 or pvd\n" },
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        expect(shell(WEFT " %s 2>&1", wrong[i][0]), 2);
        says(wrong[i][1]);
    }
}
END_TEST

START_TEST(a_list_of_methods_and_a_preset_name_what_is_near)
{
    expect(shell(WEFT " compare " OUT "/small.yaml --methods velocity_verlt 2>&1"), 2);
    says("no method 'velocity_verlt' (did you mean 'velocity_verlet'?); weft steppers");
    expect(shell("sed 's/^  density.*/  fabric: {preset: denim}/' " OUT
                 "/small.yaml > " OUT "/denim.yaml"),
           0);
    expect(shell(WEFT " check " OUT "/denim.yaml 2>&1"), 3);
    says("(did you mean '11oz-black-denim'?)");
}
END_TEST

START_TEST(what_is_no_run_is_called_so)
{
    static const char *const verbs[]
        = { "view", "resume", "view --out " OUT "/x.html" };
    for (size_t i = 0; i < sizeof verbs / sizeof verbs[0]; ++i) {
        expect(
            shell("mkdir -p " OUT "/empty && " WEFT " %s " OUT "/empty 2>&1", verbs[i]),
            4);
        says(OUT "/empty: no scene.yaml: not a run");
        expect(shell(WEFT " %s " OUT "/none 2>&1", verbs[i]), 4);
        says(OUT "/none: No such file or directory");
    }
}
END_TEST

START_TEST(a_cloth_without_springs_is_warned_of)
{
    expect(shell(WEFT " check " OUT "/small.yaml --set cloth.springs=null 2>&1"), 0);
    says("small.yaml: warning: cloth has no springs: nothing holds it together");
    expect(shell(WEFT " check " OUT "/small.yaml 2>&1"), 0);
    ck_assert_ptr_null(strstr(output, "warning"));
}
END_TEST

START_TEST(every_verb_has_help_on_stdout)
{
    static const char *const verbs[]
        = { "run", "check", "steppers", "scene-help", "export", "view" };
    for (size_t i = 0; i < sizeof verbs / sizeof verbs[0]; ++i) {
        expect(shell(WEFT " %s --help 2>/dev/null", verbs[i]), 0);
        says("usage: weft ");
        says(verbs[i]);
    }
    expect(shell(WEFT " --help"), 0);
    says("exit codes");
    expect(shell(WEFT " --version"), 0);
    says("weft " WEFT_VERSION);
    says("plugin verlet");
}
END_TEST

START_TEST(a_wrong_scene_exits_with_3_and_shows_the_place)
{
    expect(shell("sed 's/density/densty/' " OUT "/small.yaml > " OUT "/bad.yaml"), 0);
    expect(shell(WEFT " run " OUT "/bad.yaml --out " OUT "/r 2>&1"), 3);
    says(OUT "/bad.yaml:5:3: error: ");
    says("did you mean 'density'?");
    ck_assert(!exists(OUT "/r"));
    expect(shell(WEFT " check " OUT "/small.yaml " OUT "/bad.yaml 2>&1"), 3);
    says("small.yaml: ok");
    expect(shell(WEFT " check " OUT "/small.yaml --set stepper.plugin=verlett 2>&1"),
           3);
    says("did you mean 'verlet'?");
}
END_TEST

START_TEST(overrides_are_checked_like_a_scene)
{
    expect(shell(WEFT " check " OUT "/small.yaml --set run.fps=20 --set "
                      "run.duration=soon 2>&1"),
           3);
    says("override run.duration:14: error");
}
END_TEST

START_TEST(a_method_or_plugin_that_is_not_there_is_a_wrong_scene)
{
    expect(shell(WEFT " check " OUT
                      "/small.yaml --set stepper.method=velocity_verlt 2>&1"),
           3);
    says("velocity_verlet");
#ifdef HAVE_GSL
    expect(shell(WEFT " check " OUT "/small.yaml --set stepper.method=rkck 2>&1"), 3);
    says("plugin 'verlet' has no method 'rkck' (gsl has); it has");
#endif
    expect(shell(WEFT " check " OUT "/small.yaml --set stepper.plugin=nowhere 2>&1"),
           3);
    says("weft-nowhere.so");
}
END_TEST

START_TEST(a_missing_file_exits_with_4)
{
    expect(shell(WEFT " run " OUT "/none.yaml --out " OUT "/r 2>&1"), 4);
    says("none.yaml");
    expect(shell(WEFT " check " OUT "/none.yaml 2>&1"), 4);
    expect(shell(WEFT " export " OUT "/nothing --format obj 2>&1"), 4);
    write_file(OUT "/file", "");
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/file/r 2>&1"), 4);
}
END_TEST

START_TEST(a_full_disk_is_an_error_that_names_the_file)
{
    expect(shell("mkdir -p " OUT "/r && ln -s /dev/full " OUT
                 "/r/series.csv.link && " WEFT " steppers > /dev/full 2>" OUT "/err"),
           4);
    expect(shell("ulimit -f 1; trap '' XFSZ; " WEFT " run " OUT "/small.yaml --out " OUT
                 "/s --quiet --set run.fps=400 2>&1"),
           4);
    says(OUT "/s/");
    ck_assert(!exists(OUT "/s/result.yaml")
              || strstr(read_file(OUT "/s/result.yaml"), "status: io_error") != NULL);
}
END_TEST

/* 70 x 70 particles: vectors long enough for more than one thread to have a share. */
START_TEST(the_number_of_threads_changes_no_digit)
{
    static const char *const steppers[] = {
        "{plugin: verlet, method: velocity_verlet, fixed_step: 1.0e-3}",
#ifdef HAVE_GSL
        "{plugin: gsl, method: rkf45}",
#endif
#ifdef HAVE_ARKODE
        "{plugin: arkode, method: dormand_prince}",
        "{plugin: arkode, method: dormand_prince, norm: rms}",
        "{plugin: arkode, method: rk4, fixed_step: 1.0e-3}",
#endif
    };
    for (size_t i = 0; i < sizeof steppers / sizeof steppers[0]; ++i) {
        for (int threads = 1; threads <= 2; ++threads) {
            expect(shell(WEFT " run " OUT "/small.yaml --out " OUT
                              "/threads-%zu-%d --quiet --set run.duration=0.01 --set "
                              "'cloth.grid={rows: 70, cols: 70, spacing: 0.02}' --set "
                              "run.threads=%d --set 'stepper=%s' 2>&1",
                         i, threads, threads, steppers[i]),
                   0);
        }
        expect(shell("cmp " OUT "/threads-%zu-1/final.csv " OUT
                     "/threads-%zu-2/final.csv 2>&1",
                     i, i),
               0);
    }
}
END_TEST

START_TEST(what_this_version_cannot_run_it_says_and_exits_with_1)
{
    static const char table[]
        = "--set 'stepper={plugin: arkode, method: custom, butcher: "
          "{A: [[], [1/2]], b: [0, 1], c: [0, 1/2], order: 2}, "
          "fixed_step: 1e-3}' 2>&1";
    expect(shell(WEFT " check " OUT "/small.yaml %s", table), 0);
#ifdef HAVE_ARKODE
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/b %s", table), 0);
    /* of order 2 it is, and not of 3 */
    static const char *const verbs[] = { "check", "run --out " OUT "/c" };
    (void)shell("sed 's/order: 2/order: 3/' " OUT "/b/scene.yaml >" OUT "/3.yaml");
    for (size_t i = 0; i < 2; ++i) {
        expect(shell(WEFT " %s " OUT "/3.yaml 2>&1", verbs[i]), 3);
        says("/3.yaml:");
        says("error: custom: b is not of order 3");
        says("butcher:");
    }
    ck_assert(!exists(OUT "/c"));
#else
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/b %s", table), 1);
    says("butcher");
    expect(shell("grep -c 'status: failed' " OUT "/b/result.yaml"), 0);
#endif
}
END_TEST

START_TEST(a_limit_reports_what_it_did_and_what_it_could_not)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT
                      "/l --set 'limit={method: provot, strain: 0.01}' --set "
                      "'cloth.pins=[top-left, top-right]' 2>&1"),
           0);
    says("limit      1 %: ");
    ck_assert_ptr_null(strstr(output, "warning"));
    expect(shell("cat " OUT "/l/result.yaml " OUT "/l/manifest.yaml"), 0);
    says("  unconverged: 0\n");
    says("  held: 0\n");
    says("  method: provot\n  solver: fast\n");
    expect(shell("awk -F, 'NR > 2 && $15 > 0 && $17 > 0 && $17 <= 0.01102' " OUT
                 "/l/series.csv | wc -l"),
           0);
    ck_assert_int_gt(atoi(output), 0);
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/m --quiet --set 'limit="
                      "{method: provot, strain: 0, tolerance: 1e-9, sweeps: 1}' 2>&1"),
           0);
    const char *warning = "weft: warning: limit: not met within its sweeps at t = ";
    says(warning);
    ck_assert_ptr_null(strstr(strstr(output, warning) + 1, warning));
    expect(shell("grep -c 'unconverged: 0' " OUT "/m/result.yaml"), 1);
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/b --set 'limit={method: "
                      "bridson, strain: 0.01}' --set 'cloth.pins=[top-left]' 2>&1"),
           0);
    says("weft: warning: limit: not met by bridson, which corrects velocities, ");
    says("not met after ");
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/h --quiet --set limit."
                      "method=provot --set cloth.pins='[[0, 0], {at: [0, 1], "
                      "velocity: [3, 0, 0]}]' 2>&1"),
           0);
    says("weft: warning: limit: 1 springs with both ends pinned are too long");
}
END_TEST

START_TEST(a_run_that_blows_up_keeps_its_last_good_state_and_reports)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT
                      "/r --set stepper.fixed_step=0.05 --set run.duration=50 2>&1"),
           1);
    says("fastest particle");
    says("spring (");
    says(" J before that step\n");
    says("weft: warning: a fixed step of 0.05 s is beyond the largest stable step ");
    says("  stable step of verlet velocity_verlet ");
    says("  try stepper.fixed_step=");
    expect(shell("cat " OUT "/r/result.yaml"), 0);
    says("status: failed");
    says("try stepper.fixed_step=");
    ck_assert_ptr_null(strstr(read_file(OUT "/r/final.csv"), "nan"));
    ck_assert_ptr_null(strstr(read_file(OUT "/r/series.csv"), "nan"));
}
END_TEST

static void interrupt_with(const char *name, int code)
{
    expect(shell("exec 2>&1; " WEFT " run " OUT "/small.yaml --out " OUT "/%s --quiet "
                 "--set run.duration=1e5 & pid=$!; "
                 "while [ ! -s " OUT "/%s/series.csv ]; do sleep 0.05; done; "
                 "kill -%s $pid; wait $pid",
                 name, name, name),
           code);
    expect(shell("cat " OUT "/%s/result.yaml", name), 0);
    says("status: interrupted\n");
    says(name);
    expect(shell("wc -l < " OUT "/%s/final.csv", name), 0);
    ck_assert_int_eq(atoi(output), 21);
    /* what was recorded can be exported, and no more is asked for */
    expect(shell(WEFT " export " OUT "/%s --format csv --frame all 2>&1", name), 0);
    says("frames/frame-000000.csv");
}

START_TEST(a_signal_ends_a_run_with_a_valid_result)
{
    interrupt_with("INT", 130);
    interrupt_with("TERM", 143);
}
END_TEST

START_TEST(exported_frames_are_those_of_the_run)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/r --quiet --frames obj "
                      "--set record.precision=double"),
           0);
    expect(shell("mv " OUT "/r/frames " OUT "/kept && " WEFT " export " OUT
                 "/r --format obj --frame all 2>&1 && diff -r " OUT "/kept " OUT
                 "/r/frames"),
           0);
    says("frames/frame-000000.obj to frame-000010.obj, 11 files\n");
    expect(shell(WEFT " export " OUT "/r --format csv --frame 10 && cmp " OUT
                      "/r/frames/frame-000010.csv " OUT "/r/final.csv"),
           0);
    expect(shell(WEFT " export " OUT "/r --format obj && cmp " OUT "/r/final.obj " OUT
                      "/kept/frame-000010.obj"),
           0);
    expect(shell(WEFT " export " OUT "/r --format obj --frame 11 2>&1"), 2);
    expect(shell("grep -c ^f " OUT "/r/final.obj"), 0);
    ck_assert_int_eq(atoi(output), 3 * 4); /* quads of 4 x 5 particles */
}
END_TEST

START_TEST(an_export_that_does_not_match_the_run_is_refused)
{
    expect(shell(WEFT " run " OUT "/small.yaml --out " OUT "/r --quiet && rm " OUT
                      "/r/run.vtkhdf && sed -i s/0.01}/0.02}/ " OUT "/r/scene.yaml"),
           0);
    expect(shell(WEFT " export " OUT "/r --format obj --frame 5 2>&1"), 1);
    says("run.vtkhdf is missing");
    says("hash");
    expect(shell("sed -i 5s/,/x,/ " OUT "/r/final.csv; " WEFT " export " OUT
                 "/r --format obj 2>&1"),
           4);
    says("final.csv: damaged at line 5");
}
END_TEST

START_TEST(lists_for_machines_are_yaml_and_a_plugin_path_is_searched_first)
{
    expect(shell(WEFT " steppers --yaml"), 0);
    says("- id: \"verlet\"");
    says("  - name: \"symplectic_euler\"");
    expect(shell("mkdir -p " OUT "/p && cp " BUILD_DIR "/plugins/weft-verlet.so " OUT
                 "/p/ && " WEFT " steppers --plugin-path " OUT "/p"),
           0);
    says(OUT "/p/weft-verlet.so");
}
END_TEST

START_TEST(scene_help_lists_every_key)
{
    static const char *const keys[] = {
        "rows",      "spacing",  "origin",  "right",      "down",      "scale",
        "density",   "loads",    "law",     "stretch",    "stiffness", "pins",
        "amplitude", "gravity",  "wind",    "drag",       "sweeps",    "tolerance",
        "method",    "rtol",     "norm",    "first_step", "max_step",  "fixed_step",
        "butcher",   "duration", "threads", "fps",        "precision", "fields",
        "every",
    };
    expect(shell(WEFT " scene-help"), 0);
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; ++i) {
        says(keys[i]);
    }
    says("[N/m]");
}
END_TEST

START_TEST(the_example_program_runs)
{
    expect(shell(BUILD_DIR "/examples/minimal 2>&1"), 0);
    says("1.000 s: last corner at height ");
}
END_TEST

TEST_SUITE(cli)
{
    Suite *all = suite_create("cli");
    TCase *program = tcase_create("program");
    tcase_add_unchecked_fixture(program, NULL, NULL);
    tcase_add_checked_fixture(program, begin, NULL);
    tcase_set_timeout(program, 60);
    TCase *slow = test_long(all, 60);
    tcase_add_checked_fixture(slow, begin, NULL);
    tcase_add_test(program, a_run_leaves_its_files);
    tcase_add_test(program, frames_are_at_exact_times_and_the_last_at_the_duration);
    tcase_add_test(program, the_same_scene_gives_the_same_bytes);
    tcase_add_test(program, a_run_can_be_repeated_from_the_scene_it_left);
    tcase_add_test(program, a_directory_that_is_not_empty_is_refused_unless_forced);
    tcase_add_test(program, wrong_command_lines_exit_with_2);
    tcase_add_test(
        program, a_misspelt_word_of_the_command_line_is_told_with_the_one_that_is_near);
    tcase_add_test(program, a_list_of_methods_and_a_preset_name_what_is_near);
    tcase_add_test(program, what_is_no_run_is_called_so);
    tcase_add_test(program, a_cloth_without_springs_is_warned_of);
    tcase_add_test(program, every_verb_has_help_on_stdout);
    tcase_add_test(program, a_wrong_scene_exits_with_3_and_shows_the_place);
    tcase_add_test(program, overrides_are_checked_like_a_scene);
    tcase_add_test(program, a_method_or_plugin_that_is_not_there_is_a_wrong_scene);
    tcase_add_test(program, a_missing_file_exits_with_4);
    tcase_add_test(program, a_full_disk_is_an_error_that_names_the_file);
    tcase_add_test(slow, the_number_of_threads_changes_no_digit);
    tcase_add_test(program, what_this_version_cannot_run_it_says_and_exits_with_1);
    tcase_add_test(program, a_limit_reports_what_it_did_and_what_it_could_not);
    tcase_add_test(program, a_run_that_blows_up_keeps_its_last_good_state_and_reports);
    tcase_add_test(program, a_signal_ends_a_run_with_a_valid_result);
    tcase_add_test(program, exported_frames_are_those_of_the_run);
    tcase_add_test(program, an_export_that_does_not_match_the_run_is_refused);
    tcase_add_test(program,
                   lists_for_machines_are_yaml_and_a_plugin_path_is_searched_first);
    tcase_add_test(program, scene_help_lists_every_key);
    tcase_add_test(program, a_new_scene_is_one_that_runs_and_replaces_no_file);
    tcase_add_test(program, a_new_scene_has_a_name);
    tcase_add_test(program, the_laboratory_measures_what_the_fabric_is);
    tcase_add_test(program, the_laboratory_writes_into_its_directory_alone);
    tcase_add_test(program, the_example_program_runs);
    suite_add_tcase(all, program);
    return all;
}
