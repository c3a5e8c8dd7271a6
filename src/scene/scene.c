/* SPDX-License-Identifier: BSD-3-Clause */
/* scene.c -- a scene from its text and overrides: load, check, read, keep. */
#include <errno.h>
#include <locale.h>
#include <stdlib.h>
#include <string.h>

#include "scene/read.h"
#include "scene/sweep.h"

weft_scene_def weft_scene_def_default(void)
{
    return (weft_scene_def){ .file = NULL };
}

/* ---- text ------------------------------------------------------------------- */

static weft_status no_memory(weft_error *err)
{
    return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a scene");
}

/* One byte more than is allowed is read, to know. */
static weft_status read_stream(FILE *stream, const char *file, char **text,
                               size_t *length, weft_error *err)
{
    size_t capacity = 1 << 14;
    for (char *grown = NULL; (grown = realloc(*text, capacity)) != NULL;
         capacity *= 2) {
        *text = grown;
        *length += fread(grown + *length, 1, capacity - 1 - *length, stream);
        grown[*length] = '\0';
        if (ferror(stream)) {
            return weft_error_set(err, WEFT_IO, "%.200s: %s", file, strerror(errno));
        }
        if (*length < capacity - 1 || *length > WEFT__MAX_BYTES) {
            return WEFT_OK;
        }
    }
    return no_memory(err);
}

static weft_status read_file(const char *file, char **text, size_t *length,
                             weft_error *err)
{
    FILE *stream = fopen(file, "rb");
    if (stream == NULL) {
        return weft_error_set(err, WEFT_IO, "%.200s: %s", file, strerror(errno));
    }
    const weft_status status = read_stream(stream, file, text, length, err);
    (void)fclose(stream);
    return status;
}

static weft_status take_text(const weft_scene_def *def, char **text, size_t *length,
                             weft_error *err)
{
    if (def->text == NULL) {
        return read_file(def->file, text, length, err);
    }
    *text = malloc(def->length + 1);
    if (*text == NULL) {
        return no_memory(err);
    }
    memcpy(*text, def->text, def->length);
    (*text)[def->length] = '\0';
    *length = def->length;
    return WEFT_OK;
}

/* The file's name without folders and without .yaml. */
static char *name_of_file(const char *file)
{
    static const char *const endings[] = { ".yaml", ".yml" };
    const char *slash = strrchr(file, '/');
    char *name = strdup(slash == NULL ? file : slash + 1);
    const size_t length = name == NULL ? 0 : strlen(name);
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; ++i) {
        const size_t ending = strlen(endings[i]);
        if (length > ending && strcmp(name + length - ending, endings[i]) == 0) {
            name[length - ending] = '\0';
            break;
        }
    }
    return name;
}

/* ---- input ------------------------------------------------------------------ */

static const char *name_in_messages(const weft_scene_def *def)
{
    return def->file == NULL ? "scene" : def->file;
}

/* libyaml would count a byte order mark as a column. */
static weft_status make_sources(const weft_scene_def *def, weft__input *input,
                                weft_error *err)
{
    const size_t mark = strncmp(input->text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0;
    input->sources = calloc(def->set_count + 1, sizeof *input->sources);
    if (input->sources == NULL) {
        return no_memory(err);
    }
    input->sources[0] = (weft__source){ .file = name_in_messages(def),
                                        .text = input->text + mark,
                                        .length = input->length - mark };
    for (size_t i = 0; i < def->set_count; ++i) {
        input->sources[i + 1] = (weft__source){ .file = "",
                                                .text = def->sets[i],
                                                .length = strlen(def->sets[i]),
                                                .number = i + 1 };
    }
    return WEFT_OK;
}

weft_status weft__input_open(const weft_scene_def *def, weft__input *out,
                             weft_error *err)
{
    *out = (weft__input){ .text = NULL };
    if (def->file == NULL && def->text == NULL) {
        return weft_error_set(err, WEFT_INVALID, "a scene needs a file or a text");
    }
    weft_status status = take_text(def, &out->text, &out->length, err);
    status = status == WEFT_OK ? make_sources(def, out, err) : status;
    if (status != WEFT_OK) {
        weft__input_close(out);
    }
    return status;
}

void weft__input_close(weft__input *input)
{
    free(input->sources);
    free(input->text);
}

/* ---- loading ---------------------------------------------------------------- */

/* What is needed while a scene is read and not after. */
typedef struct loader {
    const weft_scene_def *def;
    const weft__input *input;
    weft_scene *scene;
    weft__report *report;
    weft_sweep *sweep; /* to be filled in, or NULL */
    yaml_document_t document;
    bool changed; /* it is no longer what was read */
    bool outside; /* the sweep has no such run */
} loader;

/* The values of one run are put in. Without a run of its own a scene with a sweep is
 * refused, and what else is wrong told of the first. */
static void resolve_sweep(loader *self)
{
    const size_t wanted = self->def->run;
    weft__sweep sweep;
    weft__sweep_take(&self->document, self->def->set_count, self->report, &sweep);
    self->changed = self->changed || sweep.present;
    self->outside = wanted > sweep.runs && sweep.runs > 0;
    if (self->sweep != NULL
        && !weft__sweep_copy(self->sweep, &self->document, &sweep)) {
        self->report->no_memory = true;
    }
    if (sweep.present && sweep.runs > 0 && wanted == 0) {
        weft__report_error(self->report, sweep.at,
                           "sweep makes %zu runs of this scene: 'weft batch' runs them",
                           sweep.runs);
    }
    if (sweep.runs > 0 && !self->outside) {
        weft__sweep_apply(&self->document, &sweep, wanted == 0 ? 1 : wanted,
                          self->report);
    }
}

/* Overrides and values of a sweep are put in before anything is checked. */
static void read_document(loader *self)
{
    for (size_t i = 1; i <= self->def->set_count; ++i) {
        weft__override_apply(&self->document, &self->input->sources[i], self->report);
    }
    self->changed = self->def->set_count > 0;
    if (yaml_document_get_root_node(&self->document)->type == YAML_MAPPING_NODE) {
        resolve_sweep(self);
    }
    if (!self->changed || weft__document_check(&self->document, self->report)) {
        weft__reader reader = { self->scene, &self->document, self->report, self->def };
        weft__read_section(&reader, &weft__root, weft__root.title,
                           yaml_document_get_root_node(&self->document), self->scene);
    }
}

static bool load_document(loader *self)
{
    const weft__source *file = &self->input->sources[0];
    const yaml_mark_t start = { 0 };
    if (file->length > WEFT__MAX_BYTES) {
        weft__report_error(self->report, start, "the file is larger than 16 MiB");
        return false;
    }
    if (!weft__document_load(file, 0, self->report, &self->document)) {
        return false;
    }
    const yaml_node_t *root = yaml_document_get_root_node(&self->document);
    if (root == NULL) {
        weft__report_error(self->report, start,
                           "the scene is empty: it begins with 'weft: 1'");
    } else if (!weft__document_check(&self->document, self->report)) {
        return true;
    } else if (root->type != YAML_MAPPING_NODE) {
        weft__report_error(self->report, root->start_mark,
                           "a scene is a mapping that begins with 'weft: 1'");
    } else {
        read_document(self);
    }
    return true;
}

/* What a right scene still lacks: its name, and its text as it was read or, if that was
 * changed, as it is now. */
static weft_status complete(loader *self, weft_error *err)
{
    weft_scene *scene = self->scene;
    if (scene->name == NULL) {
        scene->name = name_of_file(name_in_messages(self->def));
    }
    if (self->changed) {
        scene->text = weft__document_emit(&self->document);
    } else {
        yaml_document_delete(&self->document);
        scene->text = malloc(self->input->length + 1);
        if (scene->text != NULL) {
            memcpy(scene->text, self->input->text, self->input->length + 1);
        }
    }
    return scene->name == NULL || scene->text == NULL ? no_memory(err) : WEFT_OK;
}

static weft_status load(loader *self, weft_error *err)
{
    self->scene->config.struct_size = sizeof self->scene->config;
    const bool loaded = load_document(self);
    const weft_status status
        = self->report->no_memory           ? no_memory(err)
          : self->report->found->errors > 0 ? WEFT_BAD_SCENE
          : !self->outside                  ? WEFT_OK
                                            : weft_error_set(err, WEFT_INVALID,
                                                             "the sweep has no run %zu", self->def->run);
    if (loaded && status == WEFT_OK) {
        self->scene->config.threads = self->scene->run.threads;
        return complete(self, err);
    }
    if (loaded) {
        yaml_document_delete(&self->document);
    }
    return status;
}

/* Numbers are read and shown with a decimal point, whatever the embedder's locale. */
static weft_status load_in_c_locale(loader *self, weft_error *err)
{
    const locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (plain == (locale_t)0) {
        return no_memory(err);
    }
    const locale_t before = uselocale(plain);
    const weft_status status = load(self, err);
    (void)uselocale(before);
    freelocale(plain);
    return status;
}

weft_status weft__scene_read(const weft_scene_def *def, const weft__input *input,
                             weft__report *report, weft_sweep *sweep, weft_scene **out,
                             weft_error *err)
{
    loader self = { .def = def, .input = input, .report = report, .sweep = sweep };
    self.scene = calloc(1, sizeof *self.scene);
    if (self.scene == NULL) {
        return no_memory(err);
    }
    const weft_status status = load_in_c_locale(&self, err);
    if (status != WEFT_OK) {
        weft_scene_destroy(self.scene);
        return status;
    }
    *out = self.scene;
    return WEFT_OK;
}

weft_status weft_scene_load(const weft_scene_def *def, weft_scene **out,
                            weft_diagnostics *found, weft_error *err)
{
    weft__input input;
    weft__report report = { .found = found };
    *out = NULL;
    memset(found, 0, sizeof *found);
    weft_status status = weft__input_open(def, &input, err);
    if (status != WEFT_OK) {
        return status;
    }
    report.sources = input.sources;
    status = weft__scene_read(def, &input, &report, NULL, out, err);
    if (status == WEFT_OK || status == WEFT_BAD_SCENE) {
        status = weft__report_end(&report, err);
    }
    weft__input_close(&input);
    return status;
}

void weft_scene_destroy(weft_scene *scene)
{
    if (scene == NULL) {
        return;
    }
    free(scene->name);
    free(scene->text);
    free(scene->plugin);
    free(scene->method);
    free(scene->tableau.a.values);
    free(scene->tableau.b.values);
    free(scene->tableau.c.values);
    free(scene->tableau.b_embedded.values);
    free(scene->control.gains.values);
    free(scene->pins);
    free(scene->loads);
    free(scene);
}

/* ---- queries ---------------------------------------------------------------- */

const char *weft_scene_name(const weft_scene *scene)
{
    return scene->name;
}

const weft_cloth_def *weft_scene_cloth(const weft_scene *scene)
{
    return &scene->cloth;
}

const weft_limit_def *weft_scene_limit(const weft_scene *scene)
{
    return &scene->limit;
}

const weft_run_def *weft_scene_run(const weft_scene *scene)
{
    return &scene->run;
}

const weft_record_def *weft_scene_record(const weft_scene *scene)
{
    return &scene->record;
}

const char *weft_scene_plugin(const weft_scene *scene)
{
    return scene->plugin;
}

const char *weft_scene_method(const weft_scene *scene)
{
    return scene->method;
}

const weft_stepper_type *weft_scene_method_type(const weft_scene *scene)
{
    return scene->type;
}

const weft_stepper_config *weft_scene_config(const weft_scene *scene)
{
    return &scene->config;
}

const char *weft_scene_text(const weft_scene *scene)
{
    return scene->text;
}
