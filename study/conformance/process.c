/* SPDX-License-Identifier: BSD-3-Clause */
/* process.c -- the state of the process, which a method must leave unchanged. */
#include "study/conformance/trial.h"

#include <errno.h>
#include <fenv.h>
#include <float.h>
#include <locale.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include "base/hash.h"

extern char **environ;

enum { SIGNALS = 65, DESCRIPTORS = 256, TIMERS = 3 };

/* Settings that belong to the program. */
typedef struct surroundings {
    char locale[256], directory[4096];
    int rounding;
    bool subnormals, timers[TIMERS];
    struct sigaction actions[SIGNALS];
    mode_t mask;
    uint64_t environment; /* FNV-1a of all names and values */
    struct {
        dev_t device;
        ino_t file; /* 0: closed */
    } open[DESCRIPTORS];
} surroundings;

static uint64_t hash_environment(void)
{
    uint64_t hash = WEFT__HASH_START;
    for (char **name = environ; name != NULL && *name != NULL; ++name) {
        for (const char *at = *name; at == *name || at[-1] != '\0'; ++at) {
            hash = weft__hash_byte(hash, (unsigned char)*at);
        }
    }
    return hash;
}

static void look_around(surroundings *out)
{
    const volatile double smallest = DBL_MIN;
    const char *locale = setlocale(LC_ALL, NULL);
    struct stat status;
    memset(out, 0, sizeof *out);
    (void)snprintf(out->locale, sizeof out->locale, "%s", locale == NULL ? "" : locale);
    if (getcwd(out->directory, sizeof out->directory) == NULL) {
        out->directory[0] = '\0';
    }
    out->rounding = fegetround();
    out->subnormals = smallest / 2.0 > 0.0;
    for (int i = 1; i < SIGNALS; ++i) {
        (void)sigaction(i, NULL, &out->actions[i]);
    }
    for (int i = 0; i < TIMERS; ++i) {
        static const int which[TIMERS] = { ITIMER_REAL, ITIMER_VIRTUAL, ITIMER_PROF };
        struct itimerval timer = { 0 };
        (void)getitimer(which[i], &timer);
        out->timers[i] = timer.it_value.tv_sec != 0 || timer.it_value.tv_usec != 0;
    }
    out->mask = umask(0);
    (void)umask(out->mask);
    out->environment = hash_environment();
    for (int i = 0; i < DESCRIPTORS; ++i) {
        if (fstat(i, &status) == 0) {
            out->open[i].device = status.st_dev;
            out->open[i].file = status.st_ino;
        }
    }
}

static void expect_same(trial *self, const surroundings *before,
                        const surroundings *after)
{
    EXPECT(strcmp(before->locale, after->locale) == 0,
           "the locale was '%s' and is '%s'", before->locale, after->locale);
    EXPECT(before->rounding == after->rounding
               && before->subnormals == after->subnormals,
           "the floating-point environment has changed");
    for (int i = 1; i < SIGNALS; ++i) {
        EXPECT(before->actions[i].sa_handler == after->actions[i].sa_handler,
               "signal %d has another handler", i);
    }
    for (int i = 0; i < DESCRIPTORS; ++i) {
        EXPECT(before->open[i].file == after->open[i].file
                   && before->open[i].device == after->open[i].device,
               "descriptor %d was %s and is %s", i,
               before->open[i].file == 0 ? "closed" : "open",
               after->open[i].file == 0    ? "closed"
               : before->open[i].file == 0 ? "open"
                                           : "another file");
    }
    EXPECT(memcmp(before->timers, after->timers, sizeof after->timers) == 0,
           "a timer is set");
    EXPECT(strcmp(before->directory, after->directory) == 0,
           "the current directory was '%.200s' and is '%.200s'", before->directory,
           after->directory);
    EXPECT(before->mask == after->mask, "the umask was %03o and is %03o",
           (unsigned)before->mask, (unsigned)after->mask);
    EXPECT(before->environment == after->environment,
           "the environment variables have changed");
}

void weft__the_process_is_left_alone(trial *self)
{
    surroundings before, after;
#ifdef __linux__
    (void)prctl(PR_SET_CHILD_SUBREAPER, 1); /* children of children become its own */
#endif
    look_around(&before);
    trial_run *r = weft__begin_usual(self, 0);
    weft__go(self, r, 0.125);
    EXPECT(r->err.status == WEFT_OK && r->err.message[0] == '\0',
           "create and all steps succeeded, and *err is '%s'", r->err.message);
    r->model.fault = GIVE_NAN;
    (void)weft__step(r, 1.0);
    self->type->state_changed(r->self);
    weft__end(self, 0);
    look_around(&after);
    expect_same(self, &before, &after);
    EXPECT(waitpid(-1, NULL, WNOHANG) < 0 && errno == ECHILD,
           "a child process is left");
}
