#include "app/checkpoint.h"

#include <chrono>
#include <cstdio>
#include <sstream>
#include <vector>

#include "core/base/log.h"
#include "core/scene/effects_off.h"

namespace talbot {
namespace {

class SettingsText {
  public:
    void word(const std::string& key, const std::string& value) {
        text_ += (text_.empty() ? "" : " ") + key + "=" + value;
    }
    void whole(const std::string& key, uint64_t value) { word(key, std::to_string(value)); }
    void number(const std::string& key, double value) {
        char exact[40];
        std::snprintf(exact, sizeof(exact), "%a", value);
        word(key, exact);
    }
    template <typename Vec>
    void vector(const std::string& key, const Vec& v) {
        number(key + ".x", static_cast<double>(v.x));
        number(key + ".y", static_cast<double>(v.y));
        if constexpr (Vec::length() > 2) number(key + ".z", static_cast<double>(v.z));
    }
    void view(const Camera& camera) {
        const auto& [kind, position, right, up, backward, yfov, xmag, ymag] = view_of(camera);
        whole("camera.kind", static_cast<uint64_t>(kind));
        vector("camera.position", position);
        vector("camera.right", right);
        vector("camera.up", up);
        vector("camera.backward", backward);
        number("camera.yfov", yfov);
        number("camera.xmag", xmag);
        number("camera.ymag", ymag);
    }
    std::string take() { return std::move(text_); }

  private:
    std::string text_;
};

using Words = std::vector<std::pair<std::string, std::string>>;

Words words_of(const std::string& text) {
    std::istringstream words(text);
    Words pairs;
    for (std::string word; words >> word;) {
        const std::size_t equals = word.find('=');
        pairs.emplace_back(word.substr(0, equals),
                           equals == std::string::npos ? "" : word.substr(equals + 1));
    }
    return pairs;
}

const std::string* value_of(const Words& words, const std::string& key) {
    for (const auto& [name, value] : words) {
        if (name == key) return &value;
    }
    return nullptr;
}

// The first setting in which two texts differ: "KEY is A in the film, B in the render".
std::string first_difference(const std::string& film, const std::string& render) {
    const Words a = words_of(film), b = words_of(render);
    const auto told = [&](const std::string& key) {
        const std::string *x = value_of(a, key), *y = value_of(b, key);
        if (x && y && *x == *y) return std::string();
        return key + " is " + (x ? *x : "not set") + " in the film, " + (y ? *y : "not set") +
               " in the render";
    };
    for (const Words* words : {&a, &b}) {
        for (const auto& [key, value] : *words) {
            if (const std::string text = told(key); !text.empty()) return text;
        }
    }
    return "more or fewer lights";
}

}  // namespace

std::string sample_settings(const Scene& scene, const Camera& camera,
                            const RenderSettings& settings) {
    SettingsText text;
    text.word("reading", scene.reading().empty() ? "none" : scene.reading());
    text.whole("max_depth", settings.max_depth);
    text.whole("sampler", static_cast<uint64_t>(settings.sampler));
    text.whole("filter", static_cast<uint64_t>(settings.filter));
    text.whole("lights", static_cast<uint64_t>(settings.lights));
    text.whole("environment_sampling", static_cast<uint64_t>(settings.environment_sampling));
    text.whole("roulette", settings.russian_roulette);
    text.whole("nee", settings.next_event_estimation);
    if (settings.texture_filter != TextureFiltering::none)
        text.whole("texture_filter", static_cast<uint64_t>(settings.texture_filter));
    if (settings.adaptive) text.whole("adaptive", 1);
    if (settings.forced_off != EffectSet{})
        text.word("effects_off", effect_names(settings.forced_off));
    text.view(camera);
    text.number("camera.aperture_radius", camera.aperture_radius);
    text.number("camera.focus_distance", camera.focus_distance);
    text.vector("camera.lens_shift", camera.lens_shift);
    const Environment& e = scene.environment();
    text.word("environment", e.image ? e.image->sha256 : "none");
    text.vector("environment.color", e.color);
    if (e.gradient) {
        text.vector("environment.gradient", e.gradient->axis);
        text.vector("environment.from", e.gradient->from);
        text.vector("environment.to", e.gradient->to);
    }
    text.number("environment.rotation", static_cast<double>(e.rotation_degrees));
    text.number("environment.intensity", static_cast<double>(e.intensity));
    for (const PunctualLight& light : scene.punctual_lights()) {
        text.number("light.intensity", static_cast<double>(light.intensity));
        text.number("light.diameter", static_cast<double>(light.angular_diameter));
    }
    return text.take();
}

FilmMetadata film_metadata(const std::string& identity, const Scene& scene, const Camera& camera,
                           const RenderSettings& settings, const FilmView& view) {
    FilmMetadata metadata;
    metadata.scene_sha256 = identity;
    metadata.settings = sample_settings(scene, camera, settings);
    metadata.seed = settings.seed;
    metadata.first_sample = settings.first_sample;
    metadata.render_seconds = view.render_seconds;
    metadata.rays = view.rays;
    metadata.transparent_background = settings.transparent_background;
    metadata.nonfinite = view.nonfinite;
    return metadata;
}

Result<std::optional<FilmFile>> load_resume(Options& options) {
    if (options.resume.empty()) return std::optional<FilmFile>();
    Result<FilmFile> film = load_film(options.resume);
    if (!film) return film.error();
    if (!options.size) options.size = Resolution{film->film.width(), film->film.height()};
    return std::optional<FilmFile>(std::move(*film));
}

Status check_resume(const Options& options, const FilmFile& film, const SceneSetup& setup) {
    const auto refuse = [&](const std::string& what) {
        return Error{ErrorKind::bad_input, options.resume, "--resume", what};
    };
    const FilmMetadata& m = film.metadata;
    const RenderSettings& s = setup.settings;
    const auto size = [](uint32_t w, uint32_t h) {
        return std::to_string(w) + "x" + std::to_string(h);
    };
    if (film.film.width() != s.width || film.film.height() != s.height) {
        return refuse("is a film of " + size(film.film.width(), film.film.height()) +
                      ", but the render has " + size(s.width, s.height) + "; leave out --size");
    }
    if (m.scene_sha256 != setup.identity)
        return refuse(
            "is a film of another scene, or the scene's files have changed since; name the scene "
            "that it was made from");
    if (m.seed != s.seed) {
        return refuse("has seed " + std::to_string(m.seed) + "; add --seed " +
                      std::to_string(m.seed));
    }
    if (m.first_sample != s.first_sample) {
        return refuse("starts at sample " + std::to_string(m.first_sample) +
                      "; add --first-sample " + std::to_string(m.first_sample));
    }
    if (m.transparent_background != s.transparent_background)
        return refuse("has another --background; use that of the first run");
    const std::string wanted = sample_settings(*setup.scene, setup.camera, s);
    if (m.settings != wanted) {
        return refuse("was rendered with other settings (" + first_difference(m.settings, wanted) +
                      "); use those of the first run");
    }
    const uint64_t passes = film.passes();
    if (options.frames && *options.frames < passes) {
        return refuse("already has " + std::to_string(passes) +
                      " passes; --frames counts from the first of all");
    }
    return Done{};
}

CheckpointWriter::CheckpointWriter(RenderSession& session, const SceneSetup& setup,
                                   std::string file, double every_seconds)
    : session_(session),
      setup_(setup),
      file_(std::move(file)),
      every_seconds_(every_seconds),
      thread_([this] { run(); }) {}

CheckpointWriter::~CheckpointWriter() {
    {
        const std::lock_guard lock(mutex_);
        quit_ = true;
    }
    wake_.notify_all();
    thread_.join();
}

void CheckpointWriter::run() {
    std::unique_lock lock(mutex_);
    const std::chrono::duration<double> every(every_seconds_);
    while (!wake_.wait_for(lock, every, [this] { return quit_; })) {
        lock.unlock();
        save();
        lock.lock();
    }
}

void CheckpointWriter::save() {
    std::optional<FilmState> state;
    session_.with_film([&](const FilmView& view) { state.emplace(view.copy()); });
    if (state->film.pixels().empty()) return;
    const FilmView view{state->film, state->error, state->render_seconds, state->rays,
                        state->nonfinite};
    const Status saved = save_film(
        file_, view.film,
        film_metadata(setup_.identity, *setup_.scene, setup_.camera, setup_.settings, view),
        view.error);
    if (!saved) log_warning("checkpoint: " + saved.error().line());
}

}  // namespace talbot
