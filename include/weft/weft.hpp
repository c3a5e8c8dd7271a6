// SPDX-License-Identifier: BSD-3-Clause
// weft/weft.hpp -- libweft for C++17: objects that free themselves, failures as
// weft::error. The structs and the rest of the functions are those of weft/weft.h, which
// take what get() returns. Header-only.
//
// An object that uses another (a simulation its cloth, a scene its registry) must be
// destroyed first, as objects declared later are. Callbacks are called from C and must
// not throw.
#ifndef WEFT_WEFT_HPP
#define WEFT_WEFT_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "weft/plugins.h"
#include "weft/weft.h"

namespace weft {

using vec3 = std::array<double, 3>;

class error : public std::runtime_error {
public:
    explicit error(const weft_error &of, const std::string &message)
        : std::runtime_error(message), status(of.status), file(of.file), line(of.line),
          column(of.column)
    {
    }
    explicit error(const weft_error &of) : error(of, of.message) {}

    weft_status status;
    std::string file; // "" and 0, 0: no place in a file
    int line, column;
};

// Calls a function of weft whose last argument is the error, and throws what it says.
template <typename Function, typename... Arguments>
void call(Function function, Arguments... arguments)
{
    weft_error err{};
    if (function(arguments..., &err) != WEFT_OK) {
        throw error(err);
    }
}

template <typename T, void (*destroy)(T *)> struct deleter {
    void operator()(T *object) const { destroy(object); }
};

// What objects have in common: one owner, who may move it.
template <typename T, void (*destroy)(T *)> class handle {
public:
    T *get() const { return object.get(); }

protected:
    explicit handle(T *made) : object(made) {}

    // Made by a function that takes a definition and a place for the object.
    template <typename Create, typename Definition>
    static T *make(Create create, const Definition &definition)
    {
        T *made = nullptr;
        call(create, &definition, &made);
        return made;
    }

private:
    std::unique_ptr<T, deleter<T, destroy>> object;
};

class registry : public handle<weft_registry, weft_registry_destroy> {
public:
    explicit registry(const weft_registry_def &def = weft_registry_def_default())
        : handle(make(weft_registry_create, def))
    {
    }
    void add(const weft_plugin *plugin) { call(weft_registry_add, get(), plugin); }
    const weft_plugin *find(const std::string &id) const
    {
        const weft_plugin *plugin = nullptr;
        call(weft_registry_find, get(), id.c_str(), &plugin);
        return plugin;
    }
};

// A scene, from a file or from text; its message has all mistakes, a line each.
class scene : public handle<weft_scene, weft_scene_destroy> {
public:
    scene(const weft_scene_def &def, const registry &plugins)
        : handle(load(def, plugins))
    {
    }
    static scene file(const std::string &path, const registry &plugins)
    {
        weft_scene_def def = weft_scene_def_default();
        def.file = path.c_str();
        return scene(def, plugins);
    }
    static scene text(const std::string &text, const registry &plugins)
    {
        weft_scene_def def = weft_scene_def_default();
        def.text = text.c_str();
        def.length = text.size();
        return scene(def, plugins);
    }

private:
    static const weft_plugin *find(void *ctx, const char *id, weft_error *err)
    {
        const weft_plugin *plugin = nullptr;
        (void)weft_registry_find(static_cast<weft_registry *>(ctx), id, &plugin, err);
        return plugin;
    }
    static weft_scene *load(weft_scene_def def, const registry &plugins)
    {
        const auto found = std::make_unique<weft_diagnostics>();
        weft_scene *made = nullptr;
        weft_error err{};
        def.find_plugin = find;
        def.find_ctx = plugins.get();
        if (weft_scene_load(&def, &made, found.get(), &err) != WEFT_OK) {
            std::string message;
            for (std::size_t i = 0; i < found->count; ++i) {
                char one[2048];
                (void)weft_diagnostic_format(&found->items[i], one, sizeof one);
                message += (i == 0 ? "" : "\n") + std::string(one);
            }
            throw error(err, message.empty() ? err.message : message);
        }
        return made;
    }
};

class cloth : public handle<weft_cloth, weft_cloth_destroy> {
public:
    explicit cloth(const weft_cloth_def &def) : handle(make(weft_cloth_create, def)) {}
    explicit cloth(const scene &of) : cloth(*weft_scene_cloth(of.get())) {}

    std::size_t particles() const { return weft_cloth_particles(get()); }
    std::vector<std::uint32_t> triangles() const
    {
        std::vector<std::uint32_t> corners(3 * weft_cloth_triangles(get(), nullptr));
        (void)weft_cloth_triangles(get(), corners.data());
        return corners;
    }
};

// A simulation of a cloth, which must outlive it.
class sim : public handle<weft_sim, weft_sim_destroy> {
public:
    sim(const cloth &of, weft_sim_def def) : handle(create(of, def)) {}
    // As a scene defines it.
    sim(const cloth &of, const scene &defined) : sim(of, definition(defined)) {}

    double time() const { return weft_sim_time(get()); }
    void step(double t_end) { call(weft_sim_step, get(), t_end); }
    void advance(double t_end) { call(weft_sim_advance, get(), t_end); }

    std::size_t particles() const { return weft_cloth_particles(weft_sim_cloth(get())); }
    std::vector<vec3> positions() const { return triples(weft_sim_positions); }
    std::vector<vec3> velocities() const { return triples(weft_sim_velocities); }
    vec3 position(std::size_t particle) const
    {
        const weft_cloth *of = weft_sim_cloth(get());
        const double *y = weft_sim_state(get()) + weft_cloth_index(of, particle);
        return { y[0], y[particles()], y[2 * particles()] };
    }
    void vertices(float *positions, float *normals, std::size_t stride = 0) const
    {
        weft_sim_vertices(get(), positions, normals, stride);
    }

    void pin(std::size_t particle, const vec3 &velocity = {})
    {
        call(weft_sim_pin, get(), particle, velocity.data());
    }
    void pin(const std::vector<std::size_t> &particles, const std::vector<vec3> &velocities)
    {
        if (particles.size() != velocities.size()) {
            throw std::invalid_argument("weft::sim::pin: as many velocities as particles");
        }
        call(weft_sim_pin_many, get(), particles.data(),
             velocities.empty() ? nullptr : velocities.front().data(), particles.size());
    }
    void move_pin(std::size_t particle, const vec3 &position)
    {
        call(weft_sim_move_pin, get(), particle, position.data());
    }
    void unpin(std::size_t particle) { call(weft_sim_unpin, get(), particle); }
    void set_wind(const vec3 &velocity, double drag)
    {
        call(weft_sim_set_wind, get(), velocity.data(), drag);
    }
    void reset_wind() { call(weft_sim_set_wind, get(), nullptr, 0.0); }

    std::size_t add_shape(const weft_shape &shape)
    {
        std::size_t number = 0;
        call(weft_sim_add_shape, get(), &shape, &number);
        return number;
    }
    void move_shape(std::size_t shape, const vec3 &velocity)
    {
        call(weft_sim_move_shape, get(), shape, nullptr, velocity.data());
    }
    void drive_shape(std::size_t shape, const weft_shape &as)
    {
        call(weft_sim_drive_shape, get(), shape, &as);
    }
    void remove_shape(std::size_t shape) { call(weft_sim_remove_shape, get(), shape); }

    std::vector<unsigned char> save()
    {
        std::vector<unsigned char> bytes(weft_sim_save_size(get()));
        call(weft_sim_save, get(), bytes.data(), bytes.size());
        return bytes;
    }
    void restore(const std::vector<unsigned char> &bytes)
    {
        call(weft_sim_restore, get(), bytes.data(), bytes.size());
    }

private:
    static weft_sim *create(const cloth &of, weft_sim_def &def)
    {
        def.cloth = of.get();
        return make(weft_sim_create, def);
    }
    static weft_sim_def definition(const scene &of)
    {
        weft_sim_def def = weft_sim_def_default();
        def.method = weft_scene_method_type(of.get());
        def.config = *weft_scene_config(of.get());
        def.limit = *weft_scene_limit(of.get());
        return def;
    }
    std::vector<vec3> triples(void (*copy)(const weft_sim *, double *)) const
    {
        std::vector<vec3> of(particles());
        copy(get(), of.front().data());
        return of;
    }
};

} // namespace weft

#endif
