/* SPDX-License-Identifier: BSD-3-Clause */
/* scene.c -- a scene from its text and overrides: load, check, read, keep. */
#include <errno.h>
#include <locale.h>
#include <string.h>

#include "base/file.h"
#include "base/sized.h"
#include "base/stop.h"
#include "scene/checks.h"

void weft_scene_def_init(weft_scene_def *def, size_t size)
{
    const weft_scene_def start = { .struct_size = (uint32_t)size };
    weft__sized_write(def, size, &start, sizeof start);
}

/* ---- text ------------------------------------------------------------------- */

static weft_status scene_no_memory(weft_error *err)
{
    return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a scene");
}

/* Reads up to one byte more than allowed, so that a file that is too large is noticed.
 */
static weft_status read_file(weft__base *base, weft_error *err)
{
    FILE *stream = weft__file_open(base->def.file, "r", err);
    if (stream == NULL) {
        return WEFT_IO;
    }
    const bool sought = fseek(stream, 0, SEEK_END) == 0;
    const long size = sought ? ftell(stream) : -1;
    const size_t most = size < 0 || (size_t)size > WEFT__MAX_BYTES ? WEFT__MAX_BYTES + 1
                                                                   : (size_t)size;
    rewind(stream);
    base->text = weft__tree_take(&base->tree, most + 1, 1);
    weft_status status = base->text == NULL ? scene_no_memory(err) : WEFT_OK;
    if (status == WEFT_OK) {
        base->length = fread(base->text, 1, most, stream);
        if (ferror(stream)) {
            status = weft_error_set(err, WEFT_IO, "%.200s: %s", base->def.file,
                                    strerror(errno));
        }
    }
    (void)fclose(stream);
    return status;
}

static weft_status take_text(weft__base *base, weft_error *err)
{
    if (base->def.text == NULL) {
        return read_file(base, err);
    }
    base->length = base->def.length;
    base->text = weft__tree_text(&base->tree, base->def.text, base->length);
    return base->text == NULL ? scene_no_memory(err) : WEFT_OK;
}

/* ---- the tree --------------------------------------------------------------- */

static const char *name_in_messages(const weft_scene_def *def)
{
    return def->file == NULL ? "scene" : def->file;
}

/* Leaves a byte order mark out, which libyaml would count as a column. */
static weft_status make_sources(weft__base *base, weft_error *err)
{
    const weft_scene_def *def = &base->def;
    const size_t mark = weft__mark_length(base->text);
    base->sources
        = weft__tree_take(&base->tree, def->set_count + 1, sizeof *base->sources);
    if (base->sources == NULL) {
        return scene_no_memory(err);
    }
    base->sources[0] = (weft__source){ .file = name_in_messages(def),
                                       .text = base->text + mark,
                                       .length = base->length - mark };
    for (size_t i = 1; i <= def->set_count; ++i) {
        const char *set = def->sets[i - 1];
        base->sources[i] = (weft__source){ "", set, strlen(set), i };
    }
    return WEFT_OK;
}

/* Applies the overrides; checks come later. */
static void resolve(weft__base *base)
{
    const size_t sets = base->def.set_count;
    for (size_t i = 1; i <= sets; ++i) {
        weft__override_apply(&base->tree, &base->sources[i]);
    }
    weft__sweep_take(&base->tree, sets, &base->sweep);
    base->changed = sets > 0 || base->sweep.present;
    base->readable = base->sweep.runs > 0;
}

static void load_tree(weft__base *base)
{
    const weft__source *file = &base->sources[0];
    const weft__mark start = { 0 };
    weft__tree *tree = &base->tree;
    if (file->length > WEFT__MAX_BYTES) {
        weft__report_error(tree->report, start, "the file is larger than 16 MiB");
    } else if (!weft__tree_parse(tree, file, 0, &tree->root)) {
        return; /* reported */
    } else if (tree->root == NULL) {
        weft__report_error(tree->report, start,
                           "the scene is empty: it begins with 'weft: 1'");
    } else if (tree->root->type != WEFT__MAP) {
        ERROR_AT(tree, tree->root, "a scene is a mapping that begins with 'weft: 1'");
    } else {
        resolve(base);
    }
}

weft_status weft__base_open(const weft_scene_def *given, weft__base *out,
                            weft__report *report, weft_error *err)
{
    *out = (weft__base){ .sweep = { .runs = 1 } };
    weft_scene_def *const def = &out->def;
    const weft_status taken
        = WEFT__DEF_READ(weft_scene_def, def, given, WEFT__DEF_MOST, err);
    out->memory = weft_allocator_or_malloc(def->allocator);
    report->memory = &out->memory;
    out->tree.report = report;
    if (taken != WEFT_OK) {
        return taken;
    }
    if (def->file == NULL && def->text == NULL) {
        return weft_error_set(err, WEFT_INVALID, "a scene needs a file or a text");
    }
    weft_status status = take_text(out, err);
    status = status == WEFT_OK ? make_sources(out, err) : status;
    if (status == WEFT_OK) {
        report->sources = out->sources;
        load_tree(out);
        status = report->no_memory ? scene_no_memory(err) : WEFT_OK;
    }
    return status;
}

void weft__base_close(weft__base *base)
{
    weft__tree_free(&base->tree, &base->memory);
}

/* ---- reading ---------------------------------------------------------------- */

/* Writes the name that comes from the file's name into the text, which may be run from
 * another file. It leaves scene.yaml out, the name of the copy in a run's results. If
 * the text has no place for it, the tree takes it and is emitted. false: no memory. */
static bool keep_name(const weft__base *base, bool changed, weft_scene *scene)
{
    const weft__mark at = { 0 };
    weft__tree *tree = &scene->tree;
    scene->name = weft__name_of_file(tree, name_in_messages(&base->def));
    if (scene->name == NULL || strcmp(scene->name, "scene") == 0) {
        return scene->name != NULL;
    }
    if (!changed) {
        scene->text = weft__name_insert(tree, base->sources[0].text, scene->name);
        if (scene->text != NULL) {
            return true;
        }
    }
    const weft__node *value = weft__scalar_new(tree, scene->name, strlen(scene->name),
                                               YAML_DOUBLE_QUOTED_SCALAR_STYLE, at);
    if (value != NULL) {
        weft__tree_put(tree, "name", 4, at, value);
        scene->text = weft__tree_emit(tree);
    }
    return scene->text != NULL;
}

/* Adds the name of a valid scene, and its text: as it was read or, with changes, the
 * tree's. */
static weft_status complete(const weft__base *base, bool changed, weft_scene *scene,
                            weft_error *err)
{
    scene->config.threads = scene->run.threads;
    if (scene->name == NULL && !keep_name(base, changed, scene)) {
        return scene_no_memory(err);
    }
    if (scene->text == NULL) {
        scene->text = changed ? weft__tree_emit(&scene->tree)
                              : weft__tree_text(&scene->tree, base->text, base->length);
    }
    const char *file = name_in_messages(&base->def);
    scene->file = weft__tree_text(&scene->tree, file, strlen(file));
    return scene->tree.report->no_memory || scene->text == NULL ? scene_no_memory(err)
                                                                : WEFT_OK;
}

/* The tree of a run shares the nodes that it does not change. */
static weft_status read_scene(const weft__base *base, size_t run, weft__report *report,
                              weft_scene *scene, weft_error *err)
{
    weft__tree *tree = &scene->tree;
    weft__reader reader
        = { scene, tree, report, &base->def, &weft__root, weft__readers, 0 };
    *tree = (weft__tree){ .report = report, .root = base->tree.root };
    weft__sweep_apply(tree, &base->sweep, run);
    weft__resolve_method(&reader, &base->sweep);
    const bool changed = weft__take_tables(&reader) || base->changed;
    weft__read_section(&reader, &weft__root, weft__root.title, tree->root, scene);
    weft__obj_forget(&scene->obj);
    return report->no_memory            ? scene_no_memory(err)
           : report->stopped            ? weft__stopped(err)
           : report->found->errors == 0 ? complete(base, changed, scene, err)
                                        : WEFT_BAD_SCENE;
}

/* Numbers are read and shown with a decimal point, whatever the embedder's locale. */
static weft_status read_in_c_locale(const weft__base *base, size_t run,
                                    weft__report *report, weft_scene *scene,
                                    weft_error *err)
{
    const locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (plain == (locale_t)0) {
        return scene_no_memory(err);
    }
    const locale_t before = uselocale(plain);
    const weft_status status = read_scene(base, run, report, scene, err);
    (void)uselocale(before);
    freelocale(plain);
    return status;
}

weft_status weft__base_read(const weft__base *base, size_t run, weft__report *report,
                            weft_scene **out, weft_error *err)
{
    if (!base->readable) {
        return WEFT_BAD_SCENE;
    }
    weft_scene *scene = weft__zeroed(&base->memory, 1, sizeof *scene);
    if (scene == NULL) {
        return scene_no_memory(err);
    }
    scene->memory = base->memory;
    scene->config.struct_size = sizeof scene->config;
    weft__scene_begin(scene);
    scene->cloth.log = base->def.log;
    scene->cloth.stop = base->def.stop;
    scene->cloth.stop_ctx = base->def.stop_ctx;
    const weft_status status = read_in_c_locale(base, run, report, scene, err);
    scene->tree.root = NULL; /* of nodes of the base */
    scene->tree.report = NULL;
    if (status != WEFT_OK) {
        weft_scene_destroy(scene);
        return status;
    }
    *out = scene;
    return WEFT_OK;
}

weft_status weft_scene_load(const weft_scene_def *def, weft_scene **out,
                            weft_diagnostics *found, weft_error *err)
{
    weft__base base;
    weft__report report = { .found = found };
    if (weft__given(def, out, "weft_scene_load", err) != WEFT_OK) {
        return WEFT_INVALID;
    }
    *out = NULL;
    memset(found, 0, sizeof *found);
    weft_status status = weft__base_open(def, &base, &report, err);
    if (status == WEFT_OK) {
        if (base.sweep.present && base.readable) {
            weft__report_error(
                &report, base.sweep.at,
                "sweep makes %zu runs of this scene: 'weft batch' runs them",
                base.sweep.runs);
        }
        status = weft__base_read(&base, 1, &report, out, err);
    }
    if (status == WEFT_OK || status == WEFT_BAD_SCENE) {
        status = weft__report_end(&report, err);
    }
    weft__base_close(&base);
    return status;
}

void weft_scene_destroy(weft_scene *scene)
{
    if (scene == NULL) {
        return;
    }
    const weft_allocator memory = scene->memory;
    weft__obj_close(&scene->obj, &memory);
    for (size_t i = 0; i < scene->part_count; ++i) {
        weft__obj_close(&scene->parts[i].obj, &memory);
    }
    weft__tree_free(&scene->tree, &memory);
    weft__free(&memory, scene);
}

/* ---- queries ---------------------------------------------------------------- */

#define QUERY(type, name, value)                                                       \
    type weft_scene_##name(const weft_scene *scene)                                    \
    {                                                                                  \
        return value;                                                                  \
    }
QUERY(const char *, name, scene->name)
QUERY(const weft_cloth_def *, cloth, &scene->cloth)
QUERY(const weft_fabric *, fabric, scene->fabric.density > 0.0 ? &scene->fabric : NULL)
QUERY(const weft_limit_def *, limit, &scene->limit)
QUERY(const weft_run_def *, run, &scene->run)
QUERY(const weft_record_def *, record, &scene->record)
QUERY(const weft_scene_sensitivity *, sensitivities, &scene->sensitivity)
QUERY(const char *, plugin, scene->plugin)
QUERY(const char *, method, scene->method)
QUERY(const weft_stepper_type *, method_type, scene->type)
QUERY(const weft_stepper_config *, config, &scene->config)
QUERY(const char *, mesh_file, weft_scene_part_file(scene, 0))
QUERY(const char *, mesh_text, weft_scene_part_text(scene, 0))
QUERY(double, step, scene->step)
QUERY(const char *, text, scene->text)

const char *weft_scene_part_file(const weft_scene *scene, size_t k)
{
    return scene->part_count > 0 ? scene->parts[k].mesh_path : scene->mesh_path;
}

const char *weft_scene_part_text(const weft_scene *scene, size_t k)
{
    return scene->part_count > 0 ? scene->parts[k].obj.file.text : scene->obj.file.text;
}

size_t weft_scene_loose(const weft_scene *scene, size_t k, const size_t **numbers,
                        const double **places)
{
    const weft__obj *of = scene->part_count > 0 ? &scene->parts[k].obj : &scene->obj;
    if (numbers != NULL) {
        *numbers = of->loose_name;
    }
    if (places != NULL) {
        *places = of->loose_start;
    }
    return of->loose;
}

/* Note i of one cloth; takes those that it has from i. */
static const weft__note *note_of(const weft_scene *scene, size_t *i)
{
    const weft__note *at = scene->notes;
    for (; at != NULL && *i > 0; at = at->next) {
        --*i;
    }
    return at;
}

const char *weft_scene_note(const weft_scene *scene, size_t i, const char **about)
{
    const weft__note *at = note_of(scene, &i);
    for (size_t k = 0; at == NULL && k < scene->part_count; ++k) {
        at = note_of(&scene->parts[k], &i);
    }
    *about = at != NULL ? at->about : NULL;
    return at != NULL ? at->text : NULL;
}

const char *weft_scene_body_file(const weft_scene *scene, size_t i, char *copy,
                                 size_t size)
{
    const weft__body_files *at = scene->body_files;
    for (; at != NULL && i >= at->count; at = at->next) {
        i -= at->count;
    }
    if (at == NULL) {
        return NULL;
    }
    char *end = copy + weft_text_format(copy, size, WEFT__BODY_COPY, at->shape);
    (void)weft_text_format(end, size - (size_t)(end - copy),
                           at->keyed ? "-%04zu.obj" : ".obj", i);
    return at->paths[i];
}

void weft_scene_refusal(const weft_scene *scene, const weft_error *why,
                        weft_diagnostic *out)
{
    *out = scene->refusal;
    weft__fit(out->message, sizeof out->message,
              snprintf(out->message, sizeof out->message, "%s", why->message));
}
