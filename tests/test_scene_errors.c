/* SPDX-License-Identifier: BSD-3-Clause */
/* Mistakes in scenes: each has its exact message at its exact place. Every scene of
 * tests/scenes-bad has a .txt with all that is said of it. */
#include <dirent.h>
#include <stdlib.h>

#include "scene_load.h"

#define FOLDER "tests/scenes-bad"

static const char *read_text(const char *path)
{
    static char text[64 * 1024];
    FILE *stream = fopen(path, "rb");
    ck_assert_msg(stream != NULL, "no file %s", path);
    text[fread(text, 1, sizeof text - 1, stream)] = '\0';
    (void)fclose(stream);
    return text;
}

static int is_scene(const struct dirent *item)
{
    const char *dot = strrchr(item->d_name, '.');
    return dot != NULL && strcmp(dot, ".yaml") == 0;
}

START_TEST(bad_scenes_get_their_exact_messages)
{
    struct dirent **items = NULL;
    const int count = scandir(FOLDER, &items, is_scene, alphasort);
    ck_assert_int_ge(count, 50);
    for (int i = 0; i < count; ++i) {
        char path[512], wanted[512];
        (void)snprintf(path, sizeof path, FOLDER "/%s", items[i]->d_name);
        (void)snprintf(wanted, sizeof wanted, "%s", path);
        strcpy(strrchr(wanted, '.'), ".txt");
        weft_scene_def def = weft_scene_def_default();
        def.file = path;
        def.find_plugin = find_fake;
        const char *told = bad_scene(&def);
        if (getenv("WEFT_TEST_PRINT") != NULL) {
            fputs(told, stdout);
        }
        ck_assert_msg(strcmp(told, read_text(wanted)) == 0, "%s: found\n%s", path, told);
        free(items[i]);
    }
    free(items);
}
END_TEST

static Suite *suite(void)
{
    Suite *all = suite_create("scene errors");
    TCase *messages = tcase_create("messages");
    tcase_add_test(messages, bad_scenes_get_their_exact_messages);
    suite_add_tcase(all, messages);
    return all;
}

int main(void)
{
    return test_run(suite());
}
