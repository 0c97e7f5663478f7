#include "stream/wire/security/certificate.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "core/scene/text.hpp"
#include "recordings/files/staged_file.hpp"

namespace hertzline::stream {
namespace fs = std::filesystem;
namespace {

constexpr mode_t owner_only = 0600;
constexpr mode_t anyone = 0666;  // less the umask
constexpr mode_t others = 077;   // may read, write or execute
constexpr std::string_view blanks = " \t\r";

/// A file descriptor that is closed in the end.
class Descriptor {
public:
    explicit Descriptor(int number) noexcept : number_(number) {}
    ~Descriptor() {
        if (number_ >= 0) {
            ::close(number_);
        }
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int number() const noexcept { return number_; }

    /// @returns 0, or errno: some file systems report a full disk or quota only here
    int close() noexcept { return ::close(std::exchange(number_, -1)) == 0 || errno == EINTR ? 0 : errno; }

private:
    int number_;
};

// ---------------------------------------------------------------------------------------------- writing

void write_new_file(const fs::path& file, mode_t mode, std::string_view text) {
    // O_EXCL: an existing key is never lost, and a stranger's link never followed.
    Descriptor descriptor(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode));
    if (descriptor.number() < 0) {
        throw std::system_error(errno, std::generic_category(),
                                "cannot make " + printable_whole(file.string()));
    }
    const int not_written = recordings::write_all(descriptor.number(), std::as_bytes(std::span(text)));
    const int not_closed = descriptor.close();
    if (const int error = not_written != 0 ? not_written : not_closed) {
        ::unlink(file.c_str());
        throw std::system_error(error, std::generic_category(),
                                "cannot write " + printable_whole(file.string()));
    }
}

// ---------------------------------------------------------------------------------------------- reading

struct Certificate {
    std::optional<CurveKey> public_key;
    std::optional<CurveKey> secret_key;
};

bool is_mounted_read_only(int descriptor) noexcept {
    struct statvfs system {};
    return ::fstatvfs(descriptor, &system) == 0 && (system.f_flag & ST_RDONLY) != 0;
}

/// Returns the text of a file that is not too large. Its permissions are checked on the opened file, not on its name.
tl::expected<std::string, std::string> read_text(const fs::path& file, bool secret) {
    // Non-blocking: a FIFO would wait for its writer.
    const Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    struct stat status {};
    if (descriptor.number() < 0 || ::fstat(descriptor.number(), &status) != 0) {
        return tl::unexpected{fmt::format("cannot read {}: {}", printable_whole(file.string()),
                                          std::generic_category().message(errno))};
    }
    if (!S_ISREG(status.st_mode)) {
        return tl::unexpected{fmt::format("{} is not a regular file", printable_whole(file.string()))};
    }
    // Where it cannot be changed, it is as whoever mounted it decided: secrets of containers are root's, and readable for all
    // in the container.
    const bool judged = secret && !is_mounted_read_only(descriptor.number());
    if (judged && status.st_uid != ::geteuid()) {
        return tl::unexpected{fmt::format("{} belongs to another user; a secret key must be your own",
                                          printable_whole(file.string()))};
    }
    std::string text(max_certificate_bytes + 1, '\0');
    std::size_t size = 0;
    while (size < text.size()) {
        const ssize_t got = ::read(descriptor.number(), text.data() + size, text.size() - size);
        if (got < 0 && errno != EINTR) {
            return tl::unexpected{fmt::format("cannot read {}: {}", printable_whole(file.string()),
                                              std::generic_category().message(errno))};
        }
        if (got == 0) {
            break;
        }
        size += static_cast<std::size_t>(std::max<ssize_t>(got, 0));
    }
    if (size > max_certificate_bytes) {
        return tl::unexpected{fmt::format("{} is not a certificate: it has more than {} bytes",
                                          printable_whole(file.string()), max_certificate_bytes)};
    }
    text.resize(size);
    if (judged && (status.st_mode & others) != 0 && text.find("secret-key") != std::string::npos) {
        return tl::unexpected{
            fmt::format("{0}: other users may use this secret key (mode {1:04o}): chmod 600 {0}",
                        printable_whole(file.string()), status.st_mode & 07777)};
    }
    return text;
}

std::string_view unquoted(std::string_view text) {
    const bool quoted =
        text.size() >= 2 && (text.front() == '"' || text.front() == '\'') && text.front() == text.back();
    return quoted ? text.substr(1, text.size() - 2) : text;
}

tl::expected<Certificate, std::string> read_certificate(const fs::path& file, bool secret) {
    const auto text = read_text(file, secret);
    if (!text) {
        return tl::unexpected{text.error()};
    }
    Certificate certificate;
    std::string_view rest = *text;
    std::string_view section;
    for (int line_number = 1; !rest.empty(); ++line_number) {
        const std::string_view line = rest.substr(0, rest.find('\n'));
        rest.remove_prefix(std::min(rest.size(), line.size() + 1));
        const std::string_view content = trimmed(line, blanks);
        if (content.empty() || content.front() == '#') {
            continue;
        }
        if (line.front() != ' ' && line.front() != '\t') {
            section = content;
            continue;
        }
        const std::size_t equals = content.find('=');
        const std::string_view name = trimmed(content.substr(0, equals), blanks);
        if (section != "curve" || (name != "public-key" && name != "secret-key")) {
            continue;  // free for the entries of other programs
        }
        auto& key = name == "public-key" ? certificate.public_key : certificate.secret_key;
        // The value itself is not shown: it may be a secret one.
        if (key) {
            return tl::unexpected{
                fmt::format("{}:{}: a second {}", printable_whole(file.string()), line_number, name)};
        }
        const std::string_view value = equals == std::string_view::npos ? "" : content.substr(equals + 1);
        key = key_from_z85(unquoted(trimmed(value, blanks)));
        if (!key) {
            return tl::unexpected{fmt::format("{}:{}: {} is not a key of 40 characters in Z85",
                                              printable_whole(file.string()), line_number, name)};
        }
    }
    if (!certificate.public_key) {
        return tl::unexpected{fmt::format("{} is not a certificate: it has no public-key in section curve",
                                          printable_whole(file.string()))};
    }
    return certificate;
}

}  // namespace

KeyFiles write_key_files(const std::string& name, const KeyPair& pair) {
    KeyFiles files{name + ".key", name + ".key_secret"};
    const std::string body = fmt::format("metadata\ncurve\n    public-key = \"{}\"\n", z85(pair.public_key));
    write_new_file(files.secret_file, owner_only,
                   fmt::format("# CURVE key pair: the secret key is for its owner alone\n{}"
                               "    secret-key = \"{}\"\n",
                               body, z85(pair.secret_key)));
    try {
        write_new_file(files.public_file, anyone, "# CURVE public key: may be given to anybody\n" + body);
    } catch (...) {
        ::unlink(files.secret_file.c_str());  // new, and of no use alone
        throw;
    }
    return files;
}

tl::expected<CurveKey, std::string> read_public_key(const fs::path& file) {
    const auto certificate = read_certificate(file, false);
    if (!certificate) {
        return tl::unexpected{certificate.error()};
    }
    if (certificate->secret_key) {
        return tl::unexpected{
            fmt::format("{} holds a secret key, which only its owner should have: use the public "
                        "file that was made with it",
                        printable_whole(file.string()))};
    }
    return *certificate->public_key;
}

tl::expected<KeyPair, std::string> read_key_pair(const fs::path& file) {
    const auto certificate = read_certificate(file, true);
    if (!certificate) {
        return tl::unexpected{certificate.error()};
    }
    if (!certificate->secret_key) {
        return tl::unexpected{fmt::format("{} holds no secret key: use the file NAME.key_secret",
                                          printable_whole(file.string()))};
    }
    const KeyPair pair{*certificate->public_key, *certificate->secret_key};
    if (!belong_together(pair)) {
        return tl::unexpected{fmt::format("{}: its public and its secret key do not belong together",
                                          printable_whole(file.string()))};
    }
    return pair;
}

std::optional<CurveClient> read_client_keys(const std::string& own, const std::string& server,
                                            std::string_view own_name, std::string_view server_name,
                                            Faults& faults) {
    if (own.empty() && server.empty()) {
        return std::nullopt;
    }
    if (server.empty()) {
        faults.add(fmt::format("{} needs {}, the stream's public key", own_name, server_name));
        return std::nullopt;
    }
    if (own.empty()) {
        faults.add(fmt::format("{} needs {}, the client's secret key", server_name, own_name));
        return std::nullopt;
    }
    const auto pair = faults.value_of(own_name, read_key_pair(own));
    const auto key = faults.value_of(server_name, read_public_key(server));
    return pair && key ? std::optional(CurveClient{*pair, *key}) : std::nullopt;
}

tl::expected<std::vector<CurveKey>, std::string> read_public_keys(const fs::path& file_or_directory) {
    std::vector<fs::path> files;
    std::error_code error;
    if (!fs::is_directory(file_or_directory, error)) {
        files.push_back(file_or_directory);
    } else {
        for (fs::directory_iterator entry(file_or_directory, error), end; entry != end && !error;
             entry.increment(error)) {
            if (entry->path().extension() == ".key") {
                files.push_back(entry->path());
            }
        }
        if (error) {
            return tl::unexpected{fmt::format("cannot read {}: {}",
                                              printable_whole(file_or_directory.string()), error.message())};
        }
        if (files.empty()) {
            return tl::unexpected{fmt::format("{} has no certificates NAME.key: no client could connect",
                                              printable_whole(file_or_directory.string()))};
        }
        std::ranges::sort(files);  // the order of messages, not of meaning
    }
    std::vector<CurveKey> keys;
    std::string faults;
    for (const fs::path& file : files) {
        if (const auto key = read_public_key(file)) {
            keys.push_back(*key);
        } else {
            faults += (faults.empty() ? "" : "\n") + key.error();
        }
    }
    if (!faults.empty()) {
        return tl::unexpected{faults};
    }
    return keys;
}

}  // namespace hertzline::stream
