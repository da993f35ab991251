// Film files in and out. Sizes are checked against the file's length before anything is allocated,
// and the checksum before anything is believed.
#include "core/io/film_file.h"

#include <fcntl.h>
#include <openssl/evp.h>
#include <sys/file.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>

#include "core/io/image_io.h"

namespace talbot {

namespace {

static_assert(std::endian::native == std::endian::little, "film files are little-endian");
static_assert(sizeof(FilmPixel) == 64 && sizeof(Rgb) == 12);

constexpr char kMagic[8] = {'T', 'A', 'L', 'B', 'O', 'T', 'F', 'M'};
constexpr uint32_t kVersion = 4;
constexpr std::size_t kPrefixBytes = sizeof kMagic + 2 * sizeof(uint32_t);
constexpr std::size_t kDigestBytes = 32;
constexpr uint32_t kMaxHeaderBytes = 1u << 20;
constexpr uint64_t kMaxFilmBytes = 1ull << 40;
constexpr uint64_t kMaxPixels = 1ull << 32;
constexpr std::size_t kMaxMarks = 64;  // powers of two of a 64-bit count

using nlohmann::json;
using Bytes = std::span<const uint8_t>;

template <typename T>
Bytes bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const uint8_t*>(values.data()), values.size() * sizeof(T)};
}

Error unreadable(const std::filesystem::path& path, const std::string& what) {
    return {ErrorKind::bad_input, path.string(), "", what};
}

Error unwritable(const std::filesystem::path& path, const std::string& what) {
    return {ErrorKind::cannot_write, path.string(), "", what};
}

class Sha256 {
  public:
    Sha256() : context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
        TALBOT_CHECK(context_ && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1);
    }
    void add(Bytes bytes) {
        TALBOT_CHECK(EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()) == 1);
    }
    std::vector<uint8_t> digest() {
        std::vector<uint8_t> result(kDigestBytes);
        TALBOT_CHECK(EVP_DigestFinal_ex(context_.get(), result.data(), nullptr) == 1);
        return result;
    }

  private:
    std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

// A temporary beside the target. It has one name, so that a killed writer leaves at most one, and a
// lock, so that two writers cannot mix.
class AtomicFile {
  public:
    explicit AtomicFile(const std::filesystem::path& path) : path_(path), temporary_(path) {
        temporary_ += ".part";
        fd_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
        if (fd_ < 0) {
            fail();
        } else if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
            problem_ = "another process is writing it";
            ::close(fd_);
            fd_ = -1;
        } else if (::ftruncate(fd_, 0) != 0) {
            fail();
        }
    }
    ~AtomicFile() {
        if (fd_ < 0) return;
        ::unlink(temporary_.c_str());
        ::close(fd_);
    }
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    void write(Bytes bytes) {
        while (problem_.empty() && !bytes.empty()) {
            const ssize_t n = ::write(fd_, bytes.data(), bytes.size());
            if (n < 0 && errno == EINTR) continue;
            if (n <= 0) return fail();
            bytes = bytes.subspan(static_cast<std::size_t>(n));
        }
    }

    Status commit() {
        if (problem_.empty() && ::fsync(fd_) != 0) fail();
        if (problem_.empty() && ::rename(temporary_.c_str(), path_.c_str()) != 0) fail();
        if (!problem_.empty()) return unwritable(path_, "cannot write: " + problem_);
        ::close(fd_);
        fd_ = -1;
        // The new name itself must survive a power cut.
        const std::filesystem::path folder = path_.has_parent_path() ? path_.parent_path() : ".";
        if (const int directory = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
            directory >= 0) {
            ::fsync(directory);
            ::close(directory);
        }
        return Done{};
    }

  private:
    void fail() { problem_ = std::strerror(errno); }

    std::filesystem::path path_, temporary_;
    int fd_ = -1;
    std::string problem_;
};

json header_of(const Film& film, const FilmMetadata& m, const ErrorTracker::State& e) {
    const NonFiniteCount& bad = m.nonfinite;
    json header{
        {"size", {film.width(), film.height()}},
        {"scene_sha256", m.scene_sha256},
        {"settings", m.settings},
        {"seed", m.seed},
        {"first_sample", m.first_sample},
        {"passes", e.adaptive ? e.passes : film.min_samples()},
        {"render_seconds", m.render_seconds},
        {"rays", m.rays},
        {"transparent_background", m.transparent_background},
        {"nonfinite",
         {{"nan", bad.nan},
          {"inf", bad.inf},
          {"negative", bad.negative},
          {"overflow", bad.overflow}}},
    };
    if (bad.has_first) header["nonfinite"]["first"] = {bad.first_x, bad.first_y, bad.first_sample};
    json octaves = json::array(), marks = json::array();
    for (const Octave& o : e.octaves)
        octaves.push_back({o.samples, o.seconds, o.difference, o.standard_error, o.gain,
                           o.active_share, o.top_share});
    for (const ErrorTracker::Mark& mark : e.marks) marks.push_back({mark.samples, mark.seconds});
    header["error"] = {
        {"exposure_ev", e.exposure_ev},
        {"first_sample", e.first_sample},
        {"half_samples", e.half_samples},
        {"half_seconds", e.half_seconds},
        {"seconds_per_sample", e.seconds_per_sample},
        {"octaves", octaves},
        {"marks", marks},
        {"last",
         {e.last.difference, e.last.previous_difference, e.last.standard_error, e.last.top_share,
          e.last.tail_index, e.last.energy_drift, e.last.brightness_sd}},
        {"half_pixels", e.memory.image.size()},
        {"difference_pixels", e.memory.difference.size()},
        {"blocks", e.last.blocks.size()},
    };
    if (e.adaptive) {
        header["error"]["adaptive"] = {{"passes", e.passes},
                                       {"exposure_ev", e.plan_ev},
                                       {"octave", e.plan.octave},
                                       {"blocks", e.plan.blocks.size()}};
    }
    return header;
}

// Lengths of the tables that follow the film.
struct TableSizes {
    std::size_t half = 0;
    std::size_t differences = 0;
    std::size_t blocks = 0;
    std::size_t plan = 0;
};

// Fills everything but the tables; throws json::exception on anything that is missing or of another
// type.
void read_header(const json& header, FilmFile& file, TableSizes& tables) {
    const json& size = header.at("size");
    const uint32_t width = size.at(0).get<uint32_t>(), height = size.at(1).get<uint32_t>();
    FilmMetadata& m = file.metadata;
    m.scene_sha256 = header.at("scene_sha256").get<std::string>();
    m.settings = header.at("settings").get<std::string>();
    m.seed = header.at("seed").get<uint64_t>();
    m.first_sample = header.at("first_sample").get<uint64_t>();
    m.render_seconds = header.at("render_seconds").get<double>();
    m.rays = header.at("rays").get<uint64_t>();
    m.transparent_background = header.at("transparent_background").get<bool>();
    const json& bad = header.at("nonfinite");
    m.nonfinite.nan = bad.at("nan").get<uint64_t>();
    m.nonfinite.inf = bad.at("inf").get<uint64_t>();
    m.nonfinite.negative = bad.at("negative").get<uint64_t>();
    m.nonfinite.overflow = bad.at("overflow").get<uint64_t>();
    if (bad.contains("first")) {
        m.nonfinite.has_first = true;
        m.nonfinite.first_x = bad.at("first").at(0).get<uint32_t>();
        m.nonfinite.first_y = bad.at("first").at(1).get<uint32_t>();
        m.nonfinite.first_sample = bad.at("first").at(2).get<uint64_t>();
    }
    const json& error = header.at("error");
    ErrorTracker::State& e = file.error;
    e.exposure_ev = error.at("exposure_ev").get<float>();
    e.first_sample = error.at("first_sample").get<uint64_t>();
    e.half_samples = error.at("half_samples").get<uint64_t>();
    e.half_seconds = error.at("half_seconds").get<double>();
    e.seconds_per_sample = error.at("seconds_per_sample").get<double>();
    for (const json& o : error.at("octaves")) {
        e.octaves.push_back({o.at(0).get<uint64_t>(), o.at(1).get<double>(), o.at(2).get<double>(),
                             o.at(3).get<double>(), o.at(4).get<double>(),
                             o.size() > 5 ? o.at(5).get<double>() : 1.0,
                             o.size() > 6 ? o.at(6).get<double>() : 0.0});
    }
    for (const json& mark : error.at("marks"))
        e.marks.push_back({mark.at(0).get<uint64_t>(), mark.at(1).get<double>(), Film()});
    const json& last = error.at("last");
    e.last.difference = last.at(0).get<double>();
    e.last.previous_difference = last.at(1).get<double>();
    e.last.standard_error = last.at(2).get<double>();
    e.last.top_share = last.at(3).get<double>();
    e.last.tail_index = last.at(4).get<double>();
    e.last.energy_drift = last.at(5).get<double>();
    e.last.brightness_sd = last.at(6).get<double>();
    tables.half = error.at("half_pixels").get<std::size_t>();
    tables.differences = error.at("difference_pixels").get<std::size_t>();
    tables.blocks = error.at("blocks").get<std::size_t>();
    if (error.contains("adaptive")) {
        const json& adaptive = error.at("adaptive");
        e.adaptive = true;
        e.passes = adaptive.at("passes").get<uint64_t>();
        e.plan_ev = adaptive.at("exposure_ev").get<float>();
        e.plan.octave = adaptive.at("octave").get<uint64_t>();
        tables.plan = adaptive.at("blocks").get<std::size_t>();
    }
    // The tables are sized by the caller, once the file is known to hold them.
    file.film = Film();
    if (uint64_t{width} * height > kMaxPixels || e.marks.size() > kMaxMarks)
        throw json::other_error::create(501, "too large", nullptr);
}

// Takes values off the front of the payload.
class PayloadReader {
  public:
    explicit PayloadReader(Bytes payload) : left_(payload) {}
    template <typename T>
    void take(std::vector<T>& values) {
        const std::size_t count = values.size() * sizeof(T);
        TALBOT_CHECK(count <= left_.size());
        if (count != 0) std::memcpy(static_cast<void*>(values.data()), left_.data(), count);
        left_ = left_.subspan(count);
    }

  private:
    Bytes left_;
};

uint32_t read_u32(Bytes bytes, std::size_t offset) {
    uint32_t value = 0;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

// A chain of samples that passes its powers of two: the films to observe when `part` follows on
// `whole`, in order.
std::vector<ErrorTracker::Mark> marks_after(const FilmFile& whole, const FilmFile& part,
                                            const Film& joined) {
    std::vector<ErrorTracker::Mark> marks;
    for (const ErrorTracker::Mark& mark : part.error.marks) {
        marks.push_back(mark);
        marks.back().seconds += whole.metadata.render_seconds;
        marks.back().film.merge(whole.film);
    }
    const uint64_t end = part.metadata.first_sample + part.film.min_samples();
    if (std::has_single_bit(end) && (marks.empty() || marks.back().samples != end)) {
        marks.push_back(
            {end, whole.metadata.render_seconds + part.metadata.render_seconds, joined});
    }
    return marks;
}

}  // namespace

Status save_film(const std::filesystem::path& path, const Film& film, const FilmMetadata& metadata,
                 const ErrorTracker::State& error) {
    if (Status status = check_writable(path); !status) return status;
    const std::string header =
        header_of(film, metadata, error).dump(-1, ' ', false, json::error_handler_t::replace);
    if (header.size() > kMaxHeaderBytes) return unwritable(path, "its settings are too long");
    std::vector<uint8_t> prefix(kPrefixBytes);
    const uint32_t numbers[2] = {kVersion, static_cast<uint32_t>(header.size())};
    std::memcpy(prefix.data(), kMagic, sizeof kMagic);
    std::memcpy(prefix.data() + sizeof kMagic, numbers, sizeof numbers);

    AtomicFile file(path);
    Sha256 hash;
    const auto put = [&](Bytes bytes) {
        hash.add(bytes);
        file.write(bytes);
    };
    put(bytes_of(prefix));
    put({reinterpret_cast<const uint8_t*>(header.data()), header.size()});
    put(bytes_of(film.pixels()));
    put(bytes_of(error.memory.image));
    put(bytes_of(error.memory.difference));
    put(bytes_of(error.last.blocks));
    put(bytes_of(error.plan.blocks));
    put(bytes_of(error.plan.noise));
    for (const ErrorTracker::Mark& mark : error.marks) put(bytes_of(mark.film.pixels()));
    file.write(hash.digest());
    return file.commit();
}

bool is_film_file(const std::filesystem::path& path) {
    char magic[sizeof kMagic] = {};
    std::ifstream(path, std::ios::binary).read(magic, sizeof magic);
    return std::memcmp(magic, kMagic, sizeof kMagic) == 0;
}

Result<FilmFile> load_film(const std::filesystem::path& path) {
    const Result<std::vector<uint8_t>> read = read_file(path, kMaxFilmBytes);
    if (!read) return read.error();
    const Bytes bytes(*read);
    if (bytes.size() < sizeof kMagic || std::memcmp(bytes.data(), kMagic, sizeof kMagic) != 0)
        return unreadable(path, "is not a Talbot film");
    if (bytes.size() < kPrefixBytes + kDigestBytes) return unreadable(path, "is truncated");
    if (const uint32_t version = read_u32(bytes, sizeof kMagic); version != kVersion) {
        return unreadable(path, "is a film of version " + std::to_string(version) +
                                    "; this program reads version " + std::to_string(kVersion));
    }
    const uint64_t header_bytes = read_u32(bytes, sizeof kMagic + sizeof(uint32_t));
    const Bytes body = bytes.first(bytes.size() - kDigestBytes);
    if (header_bytes > kMaxHeaderBytes || kPrefixBytes + header_bytes > body.size())
        return unreadable(path, "is truncated or altered (its header does not fit)");

    FilmFile file;
    uint64_t pixels = 0;
    uint32_t size[2] = {0, 0};
    TableSizes tables;
    try {
        const char* text = reinterpret_cast<const char*>(bytes.data() + kPrefixBytes);
        const json header = json::parse(text, text + header_bytes);
        size[0] = header.at("size").at(0).get<uint32_t>();
        size[1] = header.at("size").at(1).get<uint32_t>();
        pixels = uint64_t{size[0]} * size[1];
        read_header(header, file, tables);
    } catch (const json::exception&) {
        return unreadable(path, "is truncated or altered (its header cannot be read)");
    }
    const uint64_t payload = body.size() - kPrefixBytes - header_bytes;
    const uint64_t films = 1 + file.error.marks.size();
    const bool fits = tables.half <= pixels && tables.differences <= pixels &&
                      tables.blocks <= pixels && tables.plan <= pixels &&
                      payload == films * pixels * sizeof(FilmPixel) + tables.half * sizeof(Vec3d) +
                                     tables.differences * sizeof(uint32_t) +
                                     tables.blocks * sizeof(float) +
                                     tables.plan * (sizeof(uint8_t) + sizeof(float));
    if (!fits) return unreadable(path, "is truncated or altered (its length does not fit)");
    Sha256 hash;
    hash.add(body);
    if (std::memcmp(hash.digest().data(), bytes.data() + body.size(), kDigestBytes) != 0)
        return unreadable(path, "is truncated or altered (its checksum does not fit)");

    PayloadReader reader(body.subspan(kPrefixBytes + header_bytes));
    file.film = Film(size[0], size[1]);
    file.error.memory.image.resize(tables.half);
    file.error.memory.difference.resize(tables.differences);
    file.error.last.blocks.resize(tables.blocks);
    file.error.plan.blocks.resize(tables.plan);
    file.error.plan.noise.resize(tables.plan);
    reader.take(file.film.pixels());
    reader.take(file.error.memory.image);
    reader.take(file.error.memory.difference);
    reader.take(file.error.last.blocks);
    reader.take(file.error.plan.blocks);
    reader.take(file.error.plan.noise);
    for (ErrorTracker::Mark& mark : file.error.marks) {
        mark.film = Film(size[0], size[1]);
        reader.take(mark.film.pixels());
    }
    return file;
}

Status append_film(FilmFile& whole, const FilmFile& part, const std::string& part_name) {
    const auto refuse = [&](const std::string& what) {
        return Error{ErrorKind::bad_input, part_name, "", what};
    };
    const FilmMetadata& a = whole.metadata;
    const FilmMetadata& b = part.metadata;
    if (whole.film.width() != part.film.width() || whole.film.height() != part.film.height())
        return refuse("has another size than the films before it");
    if (a.scene_sha256 != b.scene_sha256) return refuse("is a render of another scene");
    if (a.seed != b.seed) return refuse("has another seed than the films before it");
    if (a.settings != b.settings || a.transparent_background != b.transparent_background)
        return refuse("was rendered with other settings than the films before it");
    if (whole.error.adaptive || part.error.adaptive) {
        return refuse(
            "was sampled with --adaptive, where a block's count depends on all samples "
            "before; render it in one run, or its parts without");
    }
    const uint64_t passes = whole.film.min_samples();
    for (const FilmPixel& p : whole.film.pixels()) {
        if (p.samples != passes)
            return refuse("cannot follow a film that was interrupted within a pass");
    }
    const uint64_t end = a.first_sample + passes;
    if (b.first_sample != end) {
        return refuse(
            "starts at sample " + std::to_string(b.first_sample) + ", but the films before it " +
            (b.first_sample < end ? "already reach to " : "only reach to ") + std::to_string(end));
    }

    Film joined = whole.film;
    joined.merge(part.film);
    std::vector<ErrorTracker::Mark> marks = marks_after(whole, part, joined);
    if (a.first_sample == 0) {
        ErrorTracker tracker;
        tracker.restore(std::move(whole.error));
        for (const ErrorTracker::Mark& mark : marks)
            tracker.observe(mark.film, mark.samples, mark.seconds);
        whole.error = tracker.state();
    } else {
        for (ErrorTracker::Mark& mark : marks) whole.error.marks.push_back(std::move(mark));
    }
    whole.film = std::move(joined);
    whole.metadata.render_seconds += b.render_seconds;
    whole.metadata.rays += b.rays;
    whole.metadata.nonfinite.merge(b.nonfinite);
    return Done{};
}

}  // namespace talbot
