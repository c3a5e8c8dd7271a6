/* SPDX-License-Identifier: BSD-3-Clause */
/* cli.h -- declarations that the verbs share. Data goes to stdout, progress and
 * errors to stderr. */
#pragma once

#include <inttypes.h>
#include <limits.h>

#include "program/record/record.h"

/* Exit codes. */
enum {
    EXIT_DONE = 0,
    EXIT_DIFFERENT = 1,  /* of weft diff */
    EXIT_SIMULATION = 1, /* the simulation failed; a report is written */
    EXIT_USAGE = 2,      /* wrong command line */
    EXIT_SCENE = 3,      /* wrong scene */
    EXIT_FILE = 4,       /* a file could not be read or written */
    EXIT_SIGINT = 130,   /* stopped by a signal, with a valid result.yaml */
    EXIT_SIGTERM = 143
};

enum { MOST_JOBS = 4096, ANY_NUMBER = INT_MAX };

typedef enum progress_mode {
    PROGRESS_NONE,
    PROGRESS_LINES,    /* one line per tenth of the frames */
    PROGRESS_TERMINAL, /* one line, redrawn within the terminal's width */
    PROGRESS_YAML      /* one document per line */
} progress_mode;

/* The values of an option that may be repeated. */
typedef struct texts {
    const char **at;
    size_t count;
} texts;

/* The command line of a verb: what several verbs take. */
typedef struct arguments {
    const char *plugin_path, *out, *frames, *progress, *bands, *port;
    size_t jobs;  /* 0: not given */
    size_t finer; /* weft_scene_def.refine */
    texts sets;
    bool quiet, force, yaml, markdown, refine, view, watch;
    const void *own;         /* of the verb: its own_size bytes */
    bool silent;             /* mistakes of a scene are not printed */
    progress_mode mode;      /* by `progress` and `quiet` */
    const struct verb *verb; /* that was given */
    char **argv;             /* of the verb, NULL at the end */
    char **operands;         /* the rest of it */
    int operand_count;
    weft_registry *registry; /* from open_registry */
    const weft_comm *comm;   /* of the bands; NULL: one process has the whole cloth */
} arguments;

/* An option, and the member that it fills: a bool without a value, `texts` if it may be
 * repeated, the number of --jobs, or a text. */
typedef struct verb_option {
    const char *name;  /* without dashes */
    const char *value; /* what follows it; NULL: nothing */
    const char *help;
    size_t at; /* where the member is */
    bool own;  /* in arguments.own */
    bool list;
} verb_option;

/* By the size of the member. */
#define IS_LIST(type, member) (sizeof(((type *)0)->member) == sizeof(texts))
#define SHARED(member, name, value, help)                                              \
    {                                                                                  \
        name, value, help, offsetof(arguments, member), false,                         \
            IS_LIST(arguments, member)                                                 \
    }
#define OWN(type, member, name, value, help)                                           \
    {                                                                                  \
        name, value, help, offsetof(type, member), true, IS_LIST(type, member)         \
    }

/* Those that many verbs have. */
#define OPTION_PLUGIN_PATH                                                             \
    SHARED(plugin_path, "plugin-path", "DIRS", "search plugins there first ('a:b')")
#define OPTION_SET                                                                     \
    SHARED(sets, "set", "KEY.PATH=VALUE",                                              \
           "override a key of the scene; may be repeated")

/* The members of a verb for a table of options. */
#define OPTIONS(table)                                                                 \
    .options = (table), .option_count = sizeof(table) / sizeof((table)[0])

typedef struct verb {
    const char *name;
    const char *summary; /* one line */
    const char *help;    /* usage, and what it does */
    const verb_option *options;
    size_t option_count, own_size;
    const char *more; /* after the options: examples, exit codes */
    struct {
        int least, most;
        const char *few, *many; /* the errors; many NULL: as few */
    } operands;
    int (*run)(const arguments *given); /* returns the exit code */
} verb;

extern const verb verb_new, verb_lab, verb_run, verb_resume, verb_batch, verb_check,
    verb_steppers, verb_fabrics, verb_scene_help, verb_export, verb_view, verb_diff,
    verb_compare, verb_converge, verb_fit, verb_plugin_test;

/* options.c: parses the command line, argv[0] being the verb, and runs it. Returns the
 * exit code. */
int verb_start(const verb *self, int argc, char **argv);

/* ---- human.c: numbers and foreign text as people read them ---- */

enum {
    SPRING = 96,     /* bytes that hold what weft_spring_text writes */
    HUMAN_SIZE = 64, /* and weft_cloth_text */
    PAGE_WIDTH = 80  /* characters of a line */
};

typedef struct human {
    char text[32];
} human;

/* "298 us", "5.74 s", "3 min 05 s", "2 h 07 min", "3 d 04 h" */
human human_time(double seconds);
human human_count(uint64_t count); /* "40,530" */

/* The number that is all of the text, or NAN. */
double option_real(const char *text);

/* Whether a text starts with a whole number, in digits alone, and `end`. */
bool option_count(const char *text, char end, size_t *count);

/* A text made of parts; start from { "" }. */
typedef struct sentence {
    char text[1024];
} sentence;

/* Appends to a sentence; text beyond its size is cut off. */
WEFT_PRINTF(2, 3) void say(sentence *out, const char *format, ...);

/* Text that came from a file or a command line: control characters, which a terminal
 * would execute, are written as \x1b; those in `keep` are left. */
void print_plain(FILE *stream, const char *text, const char *keep);

/* A line of at most 8 KiB with such text, and its newline. */
WEFT_PRINTF(2, 3) void print_line(FILE *stream, const char *format, ...);

/* As fprintf, of at most 8 KiB that may contain such text; newlines are left. */
WEFT_PRINTF(2, 3) void print_plainly(FILE *stream, const char *format, ...);

/* Prints such text to stdout in lines of at most `width` characters, broken at blanks,
 * with a newline at the end. The first line already has `used` characters; the others
 * begin with `indent` blanks. */
void print_wrapped(size_t used, size_t indent, size_t width, const char *text);

/* "  label      text" to stdout, in lines of 80 characters. */
WEFT_PRINTF(2, 3) void print_item(const char *label, const char *format, ...);

/* The help of a verb to stdout, its paragraphs and the texts beside its options filled
 * to lines that a manual page can indent by 5. */
void print_help(const verb *of);

/* Errors. */

/* "weft: error: file:line: message" to stderr; returns the exit code of its status. */
int report_error(const weft_error *err);
/* The same with an error made of these. */
WEFT_PRINTF(2, 3) int report_status(weft_status status, const char *format, ...);

/* "weft run: <text>" and a hint at --help, to stderr; returns EXIT_USAGE. */
WEFT_PRINTF(2, 3) int usage_error(const arguments *given, const char *format, ...);

/* Finds the value of an option, or of an operand in capitals, among names, which NULL
 * ends. Returns EXIT_DONE, or EXIT_USAGE after naming them and the nearest. */
int choose(const arguments *given, const char *option, const char *typed,
           const char *const *names, size_t *chosen);

/* ---- steppers.c: every method of every plugin ---- */

typedef struct stepper_method {
    const weft_plugin *plugin;
    const weft_stepper_type *type;
} stepper_method;

/* The i-th method of all; false past the last. */
bool method_at(const weft_registry *registry, size_t i, stepper_method *out);
size_t method_count(const weft_registry *registry);
bool method_adapts(const weft_stepper_type *type);

/* The explicit one-step method of the highest order that can adapt, of a plugin other
 * than that of `but` where there is one (NULL: of any); false if there is none, or none
 * but `but`. */
bool method_best(const weft_registry *registry, const stepper_method *but,
                 stepper_method *out);

/* ---- open.c ---- */

/* A registry that looks in --plugin-path, WEFT_PLUGIN_PATH, beside the program and in
 * the installed directory. `trial`: plugins are loaded in a child process first. NULL
 * after printing why. */
weft_registry *open_registry(const char *plugin_path, bool trial);

/* Loads all plugins it finds and warns of refused ones; later calls do nothing.
 * WEFT_BAD_PLUGIN if there are none. */
weft_status load_plugins(weft_registry *registry, weft_error *err);

/* Reads a scene, or unless that is NULL a sweep: of one run for a scene without
 * `sweep`. Prints its mistakes. Returns EXIT_DONE or the exit code. */
int open_scene(const char *file, const arguments *given, weft_scene **scene,
               weft_sweep **sweep);

/* The scene of a run in a directory, likewise. */
int open_run(const char *directory, const arguments *given, weft_scene **scene);

/* --out, or the name of the scene, dir/flag.yaml, as flag followed by `suffix`. */
const char *out_directory(const arguments *given, const char *suffix,
                          char text[RECORD_PATH]);

/* Every job in a child, --jobs of them at a time; WEFT_SOLVER if none can be made.
 * tick: called now and then while they run; NULL: nothing. */
struct process;
weft_status jobs_run(const arguments *given, void *ctx, size_t jobs,
                     int (*work)(void *ctx, size_t job),
                     void (*ended)(void *ctx, const struct process *one),
                     void (*tick)(void *ctx), weft_error *err);
/* The error of a job that did not end by itself; else nothing. */
void job_error(const struct process *one, weft_error *err);

/* WEFT_UNSUPPORTED with the reason if this weft cannot run a valid scene. */
weft_status scene_supported(const weft_scene *scene, weft_error *err);

/* The cloth of a scene, or another for it. WEFT_NO_MEMORY also if a run of it cannot
 * fit into the memory of the machine, or into this process's limit. */
weft_status cloth_create(const weft_scene *scene, const weft_cloth_def *def,
                         weft_cloth **cloth, weft_error *err);

/* A simulation of that cloth as the scene, which is supported, defines it. */
weft_status sim_create(const weft_scene *scene, const weft_cloth *cloth, weft_sim **sim,
                       weft_error *err);

/* Whether the scene's method takes its cloth, which some do not: returns EXIT_DONE, or
 * prints why not at the place of the method. */
int scene_accepted(const weft_scene *scene);

/* A simulation of a scene: cloth and sim, or NULL both. */
weft_status simulation_create(const weft_scene *scene,
                              const weft_sensitivity_def *sensitivity,
                              weft_cloth **cloth, weft_sim **sim, weft_error *err);

/* The same in steps: the cloth of the scene, or its band of that comm; the first state
 * of a scene with contact.untangle, relaxed or as it is (NULL of others), which the
 * caller frees also where it fails: then it is what is left; the simulation, with the
 * first state or NULL. */
weft_status band_create(const weft_scene *scene, const weft_comm *comm,
                        weft_cloth **cloth, weft_error *err);
weft_status start_create(const weft_scene *scene, const weft_cloth *cloth, bool relax,
                         double **y, weft_error *err);
weft_status band_sim_create(const weft_scene *scene, const weft_comm *comm,
                            const weft_sensitivity_def *sensitivity, weft_log log,
                            const weft_cloth *cloth, const double *start,
                            weft_sim **sim, weft_error *err);

/* The cloths of its sensitivities, which must outlive a simulation; none: NULL. */
weft_status perturbed_create(const arguments *given, const weft_scene *scene,
                             weft_scene_perturbed **out, weft_error *err);

/* ---- run/records.c ---- */

/* WEFT_BAD_SCENE if run.vtkhdf cannot hold the frames of a scene; warns if they make it
 * large. */
weft_status frames_have_room(const weft_scene *scene, weft_error *err);
/* [bytes] of run.vtkhdf with all its frames, and their number. */
double frames_bytes(const weft_scene *scene, size_t *planned);

/* The optional columns of series.csv in runs of a scene: RECORD_... */
unsigned series_columns(const weft_scene *scene);

/* ---- run/ranks.c: a verb in bands, one process per band, started by mpirun or srun
 * and joined by weft-mpi.so. With comm NULL all functions are those of a single process
 * ---- */

/* Starts MPI, runs the verb with given->comm, ends MPI. Only rank 0 prints. Returns the
 * exit code of rank 0 on all ranks. */
int ranks_run(arguments *given);

/* Without --bands: warns in a job of several processes. */
void ranks_hint(void);

/* Whether this process prints and writes the files that are not in bands. */
static inline bool ranks_first(const weft_comm *comm)
{
    return comm == NULL || comm->rank == 0;
}

/* Collective: a number of rank 0, to all. */
int ranks_share(const weft_comm *comm, int number);

/* Collective: a text of rank 0, to all: allocated on the others, NULL if there is no
 * memory. */
char *ranks_share_text(const weft_comm *comm, const char *text);

/* Collective: warns if a rank may use fewer processors than it has threads, as
 * launchers bind ranks to cores. */
void ranks_warn(const weft_comm *comm, size_t threads);

/* ---- start.c ---- */

/* Prints how far the cloth, or each of several, is stretched at the start; nothing of a
 * grid that starts at rest. */
void start_print_stretch(const weft_cloth_def *def);

/* The same for machines. */
struct yaml_out;
void start_yaml(struct yaml_out *out, const weft_cloth_def *def);

/* ---- view.c ---- */

/* Writes the page of one run or of two into `out` or a default place and prints
 * its URL; with `yaml` as a document {event: page, url: ...}. Returns the exit code. */
int view_runs(const char *const *directories, size_t count, const char *out, bool yaml);

/* Prints "DIR: unfinished: 116 of 721 frames" to stderr for such a run. */
void report_unfinished(const char *directory);
