/* SPDX-License-Identifier: BSD-3-Clause */
/* window.c -- a hanging cloth in a window of SDL2: the mouse drags it, w begins and
 * ends a gust, escape ends. `make window` builds it.
 *
 *     window [--drag] [--frames N] [--shot FILE.bmp]
 *
 * --drag moves the mouse by itself; after N frames the picture goes to FILE. */
#include <SDL2/SDL.h>
#include <math.h>
#include <string.h>
#include <weft/plugins.h>
#include <weft/weft.h>

enum { ROWS = 30, COLS = 40, N = ROWS * COLS, TRIANGLES = 2 * (ROWS - 1) * (COLS - 1) };
enum { WIDTH = 800, HEIGHT = 600, NONE = -1 };

#define SPACING 0.025 /* [m] */
#define SCALE   520.0 /* pixels for 1 m at EYE m */
#define EYE     3.0   /* [m] from the eye to the plane z = 0 */

typedef struct app {
    weft_sim *sim;
    SDL_Window *window;
    SDL_Renderer *renderer;
    uint32_t corners[3 * TRIANGLES];
    int order[3 * TRIANGLES];
    float position[N][3], normal[N][3];
    SDL_Vertex drawn[N];
    int grabbed; /* the particle under the mouse, or NONE */
    bool windy, ended;
} app;

/* ---- the cloth ------------------------------------------------------------------- */

static weft_status make_cloth(weft_cloth **out, weft_error *err)
{
    static const weft_pin top[] = { { .rows = { 0, 0 }, .cols = { 0, 1 } },
                                    { .rows = { 0, 0 }, .cols = { 19, 20 } },
                                    { .rows = { 0, 0 }, .cols = { -2, -1 } } };
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = ROWS, def.cols = COLS;
    def.spacing[0] = def.spacing[1] = SPACING;
    def.origin[0] = -0.5 * (COLS - 1) * SPACING, def.origin[1] = 0.4;
    def.mass = 1.25e-4, def.density = 0.0;
    def.springs[WEFT_STRETCH] = (weft_spring_def){ true, 300.0, 0.01 };
    def.springs[WEFT_SHEAR] = (weft_spring_def){ true, 100.0, 0.005 };
    def.springs[WEFT_BEND] = (weft_spring_def){ true, 5.0, 0.001 };
    def.damping = 1e-4;
    def.wind_velocity[0] = 0.5, def.wind_velocity[2] = 1.5;
    def.wind_drag = 0.3;
    def.pins = top, def.pin_count = 3;
    return weft_cloth_create(&def, out, err);
}

static weft_status make_sim(const weft_cloth *cloth, weft_sim **out, weft_error *err)
{
    weft_sim_def def = weft_sim_def_default();
    def.cloth = cloth;
    def.method = weft_plugin_method(weft_plugin_verlet(), "symplectic_euler");
    def.config.fixed_step = 2.5e-4; /* [s] */
    return weft_sim_create(&def, out, err);
}

/* ---- the mouse ------------------------------------------------------------------- */

static void project(const float x[3], SDL_FPoint *to)
{
    const double scale = SCALE * EYE / (EYE - (double)x[2]);
    to->x = (float)(0.5 * WIDTH + scale * (double)x[0]);
    to->y = (float)(0.5 * HEIGHT - scale * (double)x[1]);
}

static void grab(app *of, int x, int y)
{
    double nearest = 30.0; /* pixels */
    for (int i = 0; i < N; ++i) {
        const double away = hypot((double)of->drawn[i].position.x - x,
                                  (double)of->drawn[i].position.y - y);
        if (away < nearest) {
            nearest = away;
            of->grabbed = i;
        }
    }
}

/* The grabbed particle reaches the mouse when the frame ends, and comes nearer, so that
 * the cloth folds in front of itself. */
static weft_status pull(app *of, double t_end, weft_error *err)
{
    const float *from = of->position[of->grabbed];
    const double scale = SCALE * EYE / (EYE - (double)from[2]);
    const double step = t_end - weft_sim_time(of->sim);
    int x, y;
    SDL_GetMouseState(&x, &y);
    const double velocity[3] = { ((x - 0.5 * WIDTH) / scale - (double)from[0]) / step,
                                 ((0.5 * HEIGHT - y) / scale - (double)from[1]) / step,
                                 fmin(0.5, (0.3 - (double)from[2]) / step) };
    return weft_sim_pin(of->sim, (size_t)of->grabbed, velocity, err);
}

static weft_status handle(app *of, const SDL_Event *event, weft_error *err)
{
    static const double gust[3] = { 2.0, 0.0, 6.0 }; /* [m/s] */
    const SDL_Keycode key = event->type == SDL_KEYDOWN ? event->key.keysym.sym : 0;
    of->ended = of->ended || event->type == SDL_QUIT || key == SDLK_ESCAPE;
    if (event->type == SDL_MOUSEBUTTONDOWN) {
        grab(of, event->button.x, event->button.y);
    } else if (event->type == SDL_MOUSEBUTTONUP && of->grabbed != NONE) {
        const size_t particle = (size_t)of->grabbed;
        of->grabbed = NONE;
        return weft_sim_unpin(of->sim, particle, err);
    } else if (key == SDLK_w) {
        of->windy = !of->windy;
        return weft_sim_set_wind(of->sim, of->windy ? gust : NULL, 0.3, err);
    }
    return WEFT_OK;
}

/* What a hand would do: it drags the lower right corner from frame 30 to 90. */
static void drag_alone(const app *of, int frame)
{
    const SDL_FPoint corner = of->drawn[N - 1].position;
    SDL_Event event = { 0 };
    if (frame == 30) {
        SDL_WarpMouseInWindow(of->window, (int)corner.x, (int)corner.y);
        event.type = SDL_MOUSEBUTTONDOWN;
        event.button.x = (int)corner.x, event.button.y = (int)corner.y;
        SDL_PushEvent(&event);
    } else if (frame > 30 && frame <= 90) {
        SDL_WarpMouseInWindow(of->window, (int)corner.x - 5, (int)corner.y - 3);
    } else if (frame == 120) {
        event.type = SDL_MOUSEBUTTONUP;
        SDL_PushEvent(&event);
    }
}

/* ---- drawing --------------------------------------------------------------------- */

/* The side that is seen, lit from the left, above and before. */
static SDL_Color colour(const float normal[3])
{
    const double facing = (double)normal[2] < 0.0 ? -1.0 : 1.0;
    const double light = facing
                         * (-0.4 * (double)normal[0] + 0.4 * (double)normal[1]
                            + 0.8 * (double)normal[2]);
    const double shade = 0.25 + 0.75 * (light > 0.0 ? light : 0.0);
    const bool front = (double)normal[2] >= 0.0;
    return (SDL_Color){ (Uint8)(shade * (front ? 205 : 90)), (Uint8)(shade * 80),
                        (Uint8)(shade * (front ? 70 : 190)), 255 };
}

static const app *sorted; /* qsort has no context */

static double depth(const void *triangle)
{
    const int *of = triangle;
    return (double)sorted->position[of[0]][2] + (double)sorted->position[of[1]][2]
           + (double)sorted->position[of[2]][2];
}

static int farther_first(const void *a, const void *b)
{
    return (depth(a) > depth(b)) - (depth(a) < depth(b));
}

static void draw(app *of)
{
    //! [vertices]
    weft_sim_vertices(of->sim, of->position[0], of->normal[0], 0);
    //! [vertices]
    for (int i = 0; i < N; ++i) {
        project(of->position[i], &of->drawn[i].position);
        of->drawn[i].color = colour(of->normal[i]);
    }
    for (size_t j = 0; j < (size_t)3 * TRIANGLES; ++j) {
        of->order[j] = (int)of->corners[j];
    }
    sorted = of;
    qsort(of->order, TRIANGLES, 3 * sizeof of->order[0], farther_first);
    SDL_SetRenderDrawColor(of->renderer, 24, 26, 32, 255);
    SDL_RenderClear(of->renderer);
    SDL_RenderGeometry(of->renderer, NULL, of->drawn, N, of->order, 3 * TRIANGLES);
}

static int save_picture(SDL_Renderer *renderer, const char *file)
{
    SDL_Surface *picture = SDL_CreateRGBSurfaceWithFormat(0, WIDTH, HEIGHT, 32,
                                                          SDL_PIXELFORMAT_ARGB8888);
    const int failed = picture == NULL
                       || SDL_RenderReadPixels(renderer, NULL, picture->format->format,
                                               picture->pixels, picture->pitch)
                              != 0
                       || SDL_SaveBMP(picture, file) != 0;
    SDL_FreeSurface(picture);
    return failed;
}

/* ---- the loop -------------------------------------------------------------------- */

static weft_status play(app *of, int frames, bool drags, weft_error *err)
{
    weft_status status = WEFT_OK;
    draw(of);
    for (int frame = 1; status == WEFT_OK && !of->ended; ++frame) {
        const double t = frame / 60.0; /* [s] computed, never summed */
        SDL_Event event;
        if (drags) {
            drag_alone(of, frame);
        }
        while (status == WEFT_OK && SDL_PollEvent(&event)) {
            status = handle(of, &event, err);
        }
        if (status == WEFT_OK && of->grabbed != NONE) {
            status = pull(of, t, err);
        }
        if (status == WEFT_OK) {
            status = weft_sim_advance(of->sim, t, err);
        }
        draw(of);
        of->ended = of->ended || frame == frames;
        if (!of->ended) {
            SDL_RenderPresent(of->renderer);
            SDL_Delay(frames > 0 ? 1 : 8); /* without vertical synchronisation */
        }
    }
    return status;
}

static int run(app *of, int frames, bool drags, const char *shot)
{
    weft_error err = { 0 };
    weft_cloth *cloth = NULL;
    weft_status status = make_cloth(&cloth, &err);
    status = status == WEFT_OK ? make_sim(cloth, &of->sim, &err) : status;
    if (status == WEFT_OK) {
        //! [triangles]
        (void)weft_cloth_triangles(cloth, of->corners);
        //! [triangles]
        status = play(of, frames, drags, &err);
        const float *corner = of->position[N - 1];
        printf("lower right corner at %+.3f %+.3f %+.3f m\n", (double)corner[0],
               (double)corner[1], (double)corner[2]);
    }
    if (status != WEFT_OK) {
        fprintf(stderr, "%s\n", err.message);
    }
    const int failed = shot != NULL && save_picture(of->renderer, shot);
    weft_sim_destroy(of->sim);
    weft_cloth_destroy(cloth);
    return status == WEFT_OK && !failed ? 0 : 1;
}

int main(int argc, char **argv)
{
    static app of = { .grabbed = NONE };
    const char *shot = NULL;
    int frames = 0, code = 1;
    bool drags = false;
    for (int i = 1; i < argc; ++i) {
        drags = drags || strcmp(argv[i], "--drag") == 0;
        frames = i + 1 < argc && strcmp(argv[i], "--frames") == 0 ? atoi(argv[i + 1])
                                                                  : frames;
        shot = i + 1 < argc && strcmp(argv[i], "--shot") == 0 ? argv[i + 1] : shot;
    }
    if (SDL_Init(SDL_INIT_VIDEO) == 0) {
        of.window = SDL_CreateWindow("weft", SDL_WINDOWPOS_CENTERED,
                                     SDL_WINDOWPOS_CENTERED, WIDTH, HEIGHT, 0);
        of.renderer = SDL_CreateRenderer(of.window, -1, 0);
    }
    if (of.renderer != NULL) {
        code = run(&of, frames, drags, shot);
    } else {
        fprintf(stderr, "no window: %s\n", SDL_GetError());
    }
    SDL_DestroyRenderer(of.renderer);
    SDL_DestroyWindow(of.window);
    SDL_Quit();
    return code;
}
