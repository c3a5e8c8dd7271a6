/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow */
/* weft view and weft run --view: the page they write, without a browser. What a browser
 * makes of it is tests/view/browser. */
#include "support.h"

#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#define WEFT BUILD_DIR "/weft"
#define OUT  BUILD_DIR "/view-test"

static const char scene[]
    = "weft: 1\n"
      "name: </script><script>alert(1)</script>\n"
      "cloth:\n"
      "  grid: {rows: 3, cols: 4, spacing: 0.1}\n"
      "  density: 0.3\n"
      "  springs: {stretch: {stiffness: 50}}\n"
      "  pins: [top-left]\n"
      "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 1.0e-3}\n"
      "run: {duration: 0.5, fps: 20}\n";

static char output[1 << 21];

static int shell(const char *command)
{
    FILE *pipe = popen(command, "r");
    ck_assert_ptr_nonnull(pipe);
    output[fread(output, 1, sizeof output - 1, pipe)] = '\0';
    const int status = pclose(pipe);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

static void expect(int code, const char *command)
{
    const int got = shell(command);
    ck_assert_msg(got == code, "%s: exit code %d:\n%s", command, got, output);
}

static void says(const char *text)
{
    ck_assert_msg(strstr(output, text) != NULL, "no '%s' in:\n%.2000s", text, output);
}

static size_t count(const char *text)
{
    size_t found = 0;
    for (const char *at = output; (at = strstr(at, text)) != NULL; ++at) {
        ++found;
    }
    return found;
}

static void begin(void)
{
    (void)unsetenv("WEFT_PLUGIN_PATH");
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    FILE *stream = fopen(OUT "/scene.yaml", "w");
    ck_assert_ptr_nonnull(stream);
    ck_assert_int_ge(fputs(scene, stream), 0);
    ck_assert_int_eq(fclose(stream), 0);
    expect(0, WEFT " run " OUT "/scene.yaml --out " OUT "/a --quiet 2>&1");
}

START_TEST(a_page_is_made_after_a_run_or_with_it)
{
    expect(0, WEFT " view " OUT "/a");
    says("file:///");
    says("view-test/a/run.html\n");
    expect(0, WEFT " run " OUT "/scene.yaml --out " OUT "/b --quiet --view");
    says("view-test/b/run.html\n");
    expect(0, "sed s/wall_time.*// " OUT "/a/run.html | wc -c");
    const long size = atol(output);
    expect(0, "sed s/wall_time.*// " OUT "/b/run.html | wc -c");
    ck_assert_int_eq(atol(output), size);
    expect(0, "ls " OUT "/a " OUT "/b");
    ck_assert_ptr_null(strstr(output, ".tmp"));
}
END_TEST

START_TEST(a_url_has_no_character_that_would_end_it)
{
    expect(0, WEFT " view " OUT "/a --out '" OUT "/a b%#.html'");
    says("/a%20b%25%23.html\n");
}
END_TEST

START_TEST(a_page_has_a_block_a_frame_and_no_way_out_of_its_data)
{
    expect(0, WEFT " view " OUT "/a > /dev/null && cat " OUT "/a/run.html");
    ck_assert_uint_eq(count("<script type=\"weft/frame\">"), 11);
    ck_assert_uint_eq(count("<script>alert"), 0);
    ck_assert_uint_eq(count("\\u003c/script\\u003e\\u003cscript\\u003ealert(1)"), 2);
    ck_assert_uint_eq(count("<!--WEFT-DATA-->"), 0);
    ck_assert_uint_eq(count("</script>"), 13); /* description, frames, program */
    says("\"pinned\":[0]");
    says("\"shown\":[3,4],\"stride\":1,\"chosen\":11");
    says("</html>\n");
}
END_TEST

START_TEST(two_runs_share_a_page_at_the_times_both_have)
{
    expect(0, WEFT " run " OUT "/scene.yaml --out " OUT
                   "/b --quiet --set run.fps=30 --set stepper.fixed_step=5e-4");
    expect(0, WEFT " view " OUT "/a " OUT "/b");
    says("a/compare.html\n");
    expect(0, "cat " OUT "/a/compare.html");
    says("\"times\":[0,0.10000000000000001,0.20000000000000001,0.29999999999999999,"
         "0.40000000000000002,0.5]");
    says("\"index\":[0,2,4,6,8,10]");
    says("\"index\":[0,3,6,9,12,15]");
    ck_assert_uint_eq(count("<script type=\"weft/frame\">"), 6 * 3);
}
END_TEST

START_TEST(runs_of_different_grids_are_refused)
{
    expect(0, WEFT " run " OUT "/scene.yaml --out " OUT
                   "/b --quiet --set cloth.grid.rows=5");
    expect(2, WEFT " view " OUT "/a " OUT "/b 2>&1");
    says("a has 3 x 4 particles");
    says("b 5 x 4");
    expect(0, "test ! -e " OUT "/a/compare.html");
}
END_TEST

START_TEST(what_cannot_be_shown_is_said)
{
    expect(2, WEFT " view 2>&1");
    expect(2, WEFT " view a b c 2>&1");
    expect(4, WEFT " view " OUT "/nowhere 2>&1");
    says("nowhere");
    expect(4, WEFT " view " OUT "/a --out " OUT "/nowhere/page.html 2>&1");
    says("nowhere/page.html");
    expect(4, "ulimit -f 8; trap '' XFSZ; " WEFT " view " OUT "/a 2>&1");
    says("a/run.html: File too large");
    expect(0, "test ! -e " OUT "/a/run.html && test ! -e " OUT "/a/run.html.tmp");
}
END_TEST

START_TEST(an_interrupted_or_unfinished_run_can_be_seen)
{
    expect(0, "rm " OUT "/a/result.yaml && " WEFT " view " OUT
              "/a > /dev/null && cat " OUT "/a/run.html");
    says("\"result\":null");
}
END_TEST

START_TEST(force_replaces_the_pages_too)
{
    expect(0, WEFT " view " OUT "/a && " WEFT " run " OUT "/scene.yaml --out " OUT
                   "/a --quiet --force && test ! -e " OUT "/a/run.html");
}
END_TEST

/* ---- a batch -------------------------------------------------------------------- */

static void begin_batch(void)
{
    begin();
    expect(0, "sed 's/^name:.*/name: \"<i>, 1\"/' " OUT "/scene.yaml >" OUT
              "/s.yaml && echo 'sweep: {cloth.springs.stretch.stiffness: [50, 1.0e+9], "
              "name: [\"</script>,\", b]}' >>" OUT "/s.yaml; cd " OUT
              " && ../weft batch s.yaml --out all --quiet 2>&1 | grep -v error; true");
}

START_TEST(a_batch_has_a_page_with_a_template_for_each_run)
{
    expect(0, WEFT " view " OUT "/all/ 2>&1");
    says("view-test/all/batch.html\n");
    expect(0, "cat " OUT "/all/batch.html");
    says("<script id=\"weft-batch\" type=\"application/json\">{\"weft\":\"");
    says("\"directory\":\"all\",\"summary\":\"cloth.springs.stretch.stiffness,name,"
         "scene,");
    ck_assert_uint_eq(count("<template>"), 4);
    ck_assert_uint_eq(count("</template>"), 4);
    ck_assert_uint_eq(count("id=\"weft-data\""), 4);
    ck_assert_uint_eq(count("</script>,"), 0);
    ck_assert_uint_eq(count("\"page\":false"), 4);
    says("</html>\n");
    expect(0, WEFT " view " OUT "/all/s_stiffness=50_name=b && " WEFT " view " OUT
                   "/all && cat " OUT "/all/batch.html");
    ck_assert_uint_eq(count("\"page\":true"), 1);
}
END_TEST

START_TEST(a_series_becomes_its_last_smallest_largest_and_mean_numbers)
{
    expect(0,
           "printf 'frame,time,a,hash,b\\n0,0,-3,ff,\\n1,0.5,inf,12,\\n2,1,5,0a,\\n3,"
           "2,7' >" OUT "/all/s_stiffness=50_name=b/series.csv");
    expect(0, WEFT " view " OUT "/all >/dev/null; cat " OUT "/all/batch.html");
    /* the last line was cut off; hashes are no numbers, but for some */
    says("\"columns\":{\"frame\":[2,0,2,1],\"time\":[1,0,1,0.5],\"a\":[5,-3,5,1],");
    says("\"b\":[null,null,null,null]}}");
}
END_TEST

START_TEST(runs_without_frames_are_named_and_keep_their_row)
{
    expect(0, "cd " OUT "/all && rm -r s_stiffness=50_name=b && echo damaged >"
              "s_stiffness=1.0e+9_name=b/run.vtkhdf");
    expect(0, WEFT " view " OUT "/all 2>&1");
    says("weft: warning: runs without frames: 2; the first: ");
    expect(0, "cat " OUT "/all/batch.html");
    ck_assert_uint_eq(count("<template></template>"), 2);
    ck_assert_uint_eq(count("id=\"weft-data\""), 2);
    says("{\"page\":false,\"columns\":{}}");
}
END_TEST

START_TEST(a_summary_leads_to_no_other_directory)
{
    expect(0,
           "cd " OUT " && mkdir out && ln -s ../a out/link && cp -r a out/.hidden && "
           "printf 'status,directory\\ndone,../a\\ndone,link\\ndone,.hidden\\ndone,\\n"
           "done,\"../a\"\\n' >out/summary.csv");
    expect(0, WEFT " view " OUT "/out 2>&1");
    says("runs without frames: 5");
    expect(0, "cat " OUT "/out/batch.html");
    ck_assert_uint_eq(count("<template></template>"), 5);
    ck_assert_uint_eq(count("\"columns\":{}"), 5);
    expect(0, "echo nothing >" OUT "/out/summary.csv");
    expect(4, WEFT " view " OUT "/out 2>&1");
    says("out/summary.csv: no rows with a directory");
}
END_TEST

START_TEST(players_of_many_runs_share_the_room)
{
    expect(0,
           WEFT " run " OUT "/scene.yaml --out " OUT
                "/all/large --quiet --set cloth.grid.rows=40 --set cloth.grid.cols=50 "
                "--set run.fps=60");
    expect(0,
           "cd " OUT "/all && (echo directory; yes large | head -n 200) >summary.csv");
    expect(0, WEFT " view " OUT "/all >/dev/null 2>&1; wc -c <" OUT "/all/batch.html");
    ck_assert_int_lt(atol(output), 40000000); /* whole, they would have 160 MB */
    expect(0, "grep -o '\"shown\":[^\"]*,\"stride\":[0-9]*,\"chosen\":[0-9]*' " OUT
              "/all/batch.html | sort | uniq -c");
    says("200 \"shown\":[14,18],\"stride\":3,\"chosen\":31\n");
    expect(0, "yes x | head -n 9000 >>" OUT "/all/summary.csv; " WEFT " view " OUT
              "/all && grep -c '<template>' " OUT "/all/batch.html; true");
    says("\n0\n"); /* there is room for no player */
}
END_TEST

TEST_SUITE(view)
{
    Suite *all = suite_create("view");
    TCase *pages = tcase_create("pages");
    tcase_add_checked_fixture(pages, begin, NULL);
    tcase_set_timeout(pages, 60);
    tcase_add_test(pages, a_page_is_made_after_a_run_or_with_it);
    tcase_add_test(pages, a_url_has_no_character_that_would_end_it);
    tcase_add_test(pages, a_page_has_a_block_a_frame_and_no_way_out_of_its_data);
    tcase_add_test(pages, two_runs_share_a_page_at_the_times_both_have);
    tcase_add_test(pages, runs_of_different_grids_are_refused);
    tcase_add_test(pages, what_cannot_be_shown_is_said);
    tcase_add_test(pages, an_interrupted_or_unfinished_run_can_be_seen);
    tcase_add_test(pages, force_replaces_the_pages_too);
    suite_add_tcase(all, pages);
    TCase *batch = tcase_create("batch");
    tcase_add_checked_fixture(batch, begin_batch, NULL);
    tcase_set_timeout(batch, 60);
    tcase_add_test(batch, a_batch_has_a_page_with_a_template_for_each_run);
    tcase_add_test(batch, a_series_becomes_its_last_smallest_largest_and_mean_numbers);
    tcase_add_test(batch, runs_without_frames_are_named_and_keep_their_row);
    tcase_add_test(batch, a_summary_leads_to_no_other_directory);
    suite_add_tcase(all, batch);
    TCase *slow = test_long(all, 60);
    tcase_add_checked_fixture(slow, begin_batch, NULL);
    tcase_add_test(slow, players_of_many_runs_share_the_room);
    return all;
}
