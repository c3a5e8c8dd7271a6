/* SPDX-License-Identifier: BSD-3-Clause */
/* scene.c -- a scene from its text and overrides: load, check, read, keep. */
#include <errno.h>
#include <locale.h>
#include <string.h>

#include "scene/read.h"

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
static weft_status read_stream(FILE *stream, const char *file,
                               const weft_allocator *memory, char **text,
                               size_t *length, weft_error *err)
{
    for (size_t capacity = 1 << 14;; capacity *= 2) {
        char *grown = weft__resize(memory, *text, capacity, 1);
        if (grown == NULL) {
            return no_memory(err);
        }
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
}

static weft_status read_file(const char *file, const weft_allocator *memory,
                             char **text, size_t *length, weft_error *err)
{
    FILE *stream = fopen(file, "rb");
    if (stream == NULL) {
        return weft_error_set(err, WEFT_IO, "%.200s: %s", file, strerror(errno));
    }
    const weft_status status = read_stream(stream, file, memory, text, length, err);
    (void)fclose(stream);
    return status;
}

static weft_status take_text(const weft_scene_def *def, const weft_allocator *memory,
                             char **text, size_t *length, weft_error *err)
{
    if (def->text == NULL) {
        return read_file(def->file, memory, text, length, err);
    }
    *text = def->length == SIZE_MAX ? NULL : weft__alloc(memory, def->length + 1, 1);
    if (*text == NULL) {
        return no_memory(err);
    }
    memcpy(*text, def->text, def->length);
    (*text)[def->length] = '\0';
    *length = def->length;
    return WEFT_OK;
}

/* The file's name without folders and without .yaml. */
static char *name_of_file(const char *file, const weft_allocator *memory)
{
    static const char *const endings[] = { ".yaml", ".yml" };
    const char *slash = strrchr(file, '/');
    char *name = weft__copy_text(memory, slash == NULL ? file : slash + 1);
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

/* ---- loading ---------------------------------------------------------------- */

/* What is needed while a scene is read and not after. */
typedef struct loader {
    const weft_scene_def *def;
    weft_scene *scene;
    weft__source *sources; /* the file, then the overrides */
    weft__report report;
    yaml_document_t document;
} loader;

static const char *name_in_messages(const weft_scene_def *def)
{
    return def->file == NULL ? "scene" : def->file;
}

/* libyaml would count a byte order mark as a column. */
static weft_status make_sources(loader *self, size_t length, weft_error *err)
{
    const weft_scene_def *def = self->def;
    const bool mark = strncmp(self->scene->text, "\xEF\xBB\xBF", 3) == 0;
    self->sources
        = weft__zeroed(self->report.memory, def->set_count + 1, sizeof *self->sources);
    if (self->sources == NULL) {
        return no_memory(err);
    }
    self->sources[0] = (weft__source){ .file = name_in_messages(def),
                                       .text = self->scene->text + (mark ? 3 : 0),
                                       .length = length - (mark ? 3 : 0) };
    for (size_t i = 0; i < def->set_count; ++i) {
        self->sources[i + 1] = (weft__source){ .file = "",
                                               .text = def->sets[i],
                                               .length = strlen(def->sets[i]),
                                               .number = i + 1 };
    }
    self->report.sources = self->sources;
    return WEFT_OK;
}

/* Overrides are put in before anything is checked. */
static bool load_document(loader *self)
{
    const weft__source *file = &self->sources[0];
    const yaml_mark_t start = { 0 };
    if (file->length > WEFT__MAX_BYTES) {
        weft__report_error(&self->report, start, "the file is larger than 16 MiB");
        return false;
    }
    if (!weft__document_load(file, 0, &self->report, &self->document)) {
        return false;
    }
    const yaml_node_t *root = yaml_document_get_root_node(&self->document);
    if (root == NULL) {
        weft__report_error(&self->report, start,
                           "the scene is empty: it begins with 'weft: 1'");
    } else if (!weft__document_check(&self->document, &self->report)) {
        return true;
    } else if (root->type != YAML_MAPPING_NODE) {
        weft__report_error(&self->report, root->start_mark,
                           "a scene is a mapping that begins with 'weft: 1'");
    } else {
        for (size_t i = 1; i <= self->def->set_count; ++i) {
            weft__override_apply(&self->document, &self->sources[i], &self->report);
        }
        if (self->def->set_count == 0
            || weft__document_check(&self->document, &self->report)) {
            weft__reader reader
                = { self->scene, &self->document, &self->report, self->def };
            weft__read_section(&reader, &weft__root, weft__root.title,
                               yaml_document_get_root_node(&self->document),
                               self->scene);
        }
    }
    return true;
}

/* The message for those who ask for one only. */
static weft_status first_error(const weft_diagnostics *found, weft_error *err)
{
    const weft_diagnostic *item = NULL;
    for (size_t i = 0; i < found->count && item == NULL; ++i) {
        item = found->items[i].warning ? NULL : &found->items[i];
    }
    if (item == NULL) {
        return weft_error_set(err, WEFT_BAD_SCENE, "the scene has mistakes");
    }
    weft_error_set(err, WEFT_BAD_SCENE, "%s", item->message);
    if (err != NULL) {
        (void)snprintf(err->file, sizeof err->file, "%s", item->place);
        err->line = item->line;
        err->column = item->column;
    }
    return WEFT_BAD_SCENE;
}

/* What a right scene still lacks: its name, and its text if overrides changed it. */
static weft_status complete(loader *self, weft_error *err)
{
    weft_scene *scene = self->scene;
    if (scene->name == NULL) {
        scene->name = name_of_file(name_in_messages(self->def), &scene->memory);
    }
    if (self->def->set_count > 0) {
        weft__free(&scene->memory, scene->text);
        scene->text = weft__document_emit(&self->document, &scene->memory);
    } else {
        yaml_document_delete(&self->document);
    }
    return scene->name == NULL || scene->text == NULL ? no_memory(err) : WEFT_OK;
}

static weft_status load(loader *self, weft_error *err)
{
    size_t length = 0;
    weft_status status
        = take_text(self->def, self->report.memory, &self->scene->text, &length, err);
    if (status == WEFT_OK) {
        status = make_sources(self, length, err);
    }
    if (status != WEFT_OK) {
        return status;
    }
    self->scene->config.struct_size = sizeof self->scene->config;
    const bool loaded = load_document(self);
    weft__report_finish(&self->report);
    if (loaded && !self->report.no_memory && self->report.found->errors == 0) {
        self->scene->config.threads = self->scene->run.threads;
        return complete(self, err);
    }
    if (loaded) {
        yaml_document_delete(&self->document);
    }
    return self->report.no_memory ? no_memory(err)
                                  : first_error(self->report.found, err);
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

weft_status weft_scene_load(const weft_scene_def *def, weft_scene **out,
                            weft_diagnostics *found, weft_error *err)
{
    *out = NULL;
    memset(found, 0, sizeof *found);
    if (def->file == NULL && def->text == NULL) {
        return weft_error_set(err, WEFT_INVALID, "a scene needs a file or a text");
    }
    const weft_allocator memory = weft_allocator_or_malloc(def->allocator);
    loader self = { .def = def, .report = { .found = found, .memory = &memory } };
    self.scene = weft__zeroed(&memory, 1, sizeof *self.scene);
    if (self.scene == NULL) {
        return no_memory(err);
    }
    self.scene->memory = memory;
    const weft_status status = load_in_c_locale(&self, err);
    weft__free(&memory, self.sources);
    if (status != WEFT_OK) {
        weft_scene_destroy(self.scene);
        return status;
    }
    *out = self.scene;
    return WEFT_OK;
}

void weft_scene_destroy(weft_scene *scene)
{
    if (scene == NULL) {
        return;
    }
    const weft_allocator memory = scene->memory;
    void *const parts[] = { scene->name,
                            scene->text,
                            scene->plugin,
                            scene->method,
                            scene->tableau.a.values,
                            scene->tableau.b.values,
                            scene->tableau.c.values,
                            scene->tableau.b_embedded.values,
                            scene->control.gains.values,
                            scene->pins,
                            scene->loads };
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; ++i) {
        weft__free(&memory, parts[i]);
    }
    weft__free(&memory, scene);
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
