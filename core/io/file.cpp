// Whole files in and out, and their hash. A file is written beside its name and then renamed, so
// that a reader never sees half.
#include <fcntl.h>
#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>

#include "core/io/image_io.h"

namespace talbot {

namespace {

Error cannot_read(const std::filesystem::path& file, const std::string& why) {
    return {ErrorKind::bad_input, file.string(), "", why};
}

Error cannot_write(const std::filesystem::path& file, const std::string& why) {
    return {ErrorKind::cannot_write, file.string(), "", "cannot write: " + why};
}

Error cannot_write(const std::filesystem::path& file) {
    return cannot_write(file, std::strerror(errno));
}

class FileDescriptor {
  public:
    explicit FileDescriptor(int fd) : fd_(fd) {}
    ~FileDescriptor() {
        if (fd_ >= 0) ::close(fd_);
    }
    FileDescriptor(const FileDescriptor&) = delete;
    FileDescriptor& operator=(const FileDescriptor&) = delete;

    int get() const { return fd_; }
    bool close() {
        const int fd = std::exchange(fd_, -1);
        return ::close(fd) == 0;
    }

  private:
    int fd_;
};

// Where a write to `file` ends up: links are followed, so that the link stays one; what is no
// regular file, or may not be written, is refused rather than replaced.
Result<std::filesystem::path> write_target(const std::filesystem::path& file) {
    std::error_code code;
    std::filesystem::path target = file;
    if (std::filesystem::is_symlink(file, code)) {
        target = std::filesystem::weakly_canonical(file, code);
        if (code) return cannot_write(file, code.message());
    }
    struct stat about {};
    if (::stat(target.c_str(), &about) != 0) {
        if (errno != ENOENT && errno != ENOTDIR) return cannot_write(file);
        return target;
    }
    if (!S_ISREG(about.st_mode))
        return Error{ErrorKind::cannot_write, file.string(), "", "is not a regular file"};
    if (::access(target.c_str(), W_OK) != 0) return cannot_write(file);
    return target;
}

bool write_all(int fd, std::span<const uint8_t> bytes) {
    while (!bytes.empty()) {
        const ssize_t n = ::write(fd, bytes.data(), bytes.size());
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return false;
        bytes = bytes.subspan(static_cast<size_t>(n));
    }
    return true;
}

}  // namespace

Result<std::vector<uint8_t>> read_file(const std::filesystem::path& file, uint64_t max_bytes) {
    // A pipe without a writer must not be waited for: it is refused below.
    FileDescriptor in(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (in.get() < 0) return cannot_read(file, std::string("cannot open: ") + std::strerror(errno));
    struct stat about {};
    if (::fstat(in.get(), &about) != 0)
        return cannot_read(file, std::string("cannot read: ") + std::strerror(errno));
    if (!S_ISREG(about.st_mode)) return cannot_read(file, "is not a regular file");
    const auto size = static_cast<uint64_t>(about.st_size);
    if (size > max_bytes) {
        return cannot_read(file, "is " + std::to_string(size) +
                                     " bytes long, more than the limit of " +
                                     std::to_string(max_bytes));
    }
    std::vector<uint8_t> bytes(size);
    size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t n = ::read(in.get(), bytes.data() + done, bytes.size() - done);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return cannot_read(file, std::string("cannot read: ") + std::strerror(errno));
        if (n == 0) break;
        done += static_cast<size_t>(n);
    }
    bytes.resize(done);
    return bytes;
}

Status check_writable(const std::filesystem::path& file) {
    const Result<std::filesystem::path> target = write_target(file);
    if (!target) return target.error();
    std::filesystem::path folder = target->parent_path();
    if (folder.empty()) folder = ".";
    std::error_code code;
    if (!std::filesystem::is_directory(folder, code)) {
        return Error{ErrorKind::cannot_write, file.string(), "",
                     "the folder '" + folder.string() + "' does not exist"};
    }
    if (::access(folder.c_str(), W_OK) != 0) return cannot_write(file);
    return Done{};
}

Status write_file_atomically(const std::filesystem::path& file, std::span<const uint8_t> bytes) {
    static std::atomic<unsigned> counter{0};
    const Result<std::filesystem::path> target = write_target(file);
    if (!target) return target.error();
    std::filesystem::path temporary = *target;
    temporary += ".part" + std::to_string(::getpid()) + "." + std::to_string(counter.fetch_add(1));
    FileDescriptor out(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (out.get() < 0) return cannot_write(file);
    if (!write_all(out.get(), bytes) || !out.close() ||
        ::rename(temporary.c_str(), target->c_str()) != 0) {
        const Error error = cannot_write(file);
        ::unlink(temporary.c_str());
        return error;
    }
    return Done{};
}

std::string sha256_hex(std::span<const uint8_t> bytes) {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned length = 0;
    TALBOT_CHECK(
        EVP_Digest(bytes.data(), bytes.size(), digest.data(), &length, EVP_sha256(), nullptr) == 1);
    static constexpr char kDigits[] = "0123456789abcdef";
    std::string text;
    for (unsigned i = 0; i < length; ++i) {
        text += kDigits[digest[i] >> 4];
        text += kDigits[digest[i] & 15];
    }
    return text;
}

std::string sha256_hex(std::string_view text) {
    return sha256_hex(
        std::span<const uint8_t>(reinterpret_cast<const uint8_t*>(text.data()), text.size()));
}

}  // namespace talbot
