/* SPDX-License-Identifier: BSD-3-Clause */
/* run.c -- the program of the tests: `run cloth scene` runs the suites of test_cloth.c
 * and test_scene.c one after another. */
#include "support.h"

#include <stdio.h>
#include <string.h>

/* suites.h, which the Makefile writes, has a line SUITE(cloth) for each. */
#define SUITE(name) Suite *name##_suite(void);
#include "suites.h"
#undef SUITE

#define SUITE(name) { #name, name##_suite },
static const struct {
    const char *name;
    Suite *(*make)(void);
} suites[] = {
#include "suites.h"
};

static int run(const char *name)
{
    for (size_t i = 0; i < sizeof suites / sizeof suites[0]; ++i) {
        if (strcmp(suites[i].name, name) == 0) {
            Suite *suite = suites[i].make();
            return suite == NULL ? 1 : test_run(suite);
        }
    }
    (void)fprintf(stderr, "there is no suite '%s'\n", name);
    return 1;
}

int main(int argc, char **argv)
{
    int failed = 0;
    for (int i = 1; i < argc; ++i) {
        failed |= run(argv[i]);
    }
    return failed;
}
