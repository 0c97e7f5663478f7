// hertzline keys: a key pair for a stream that encrypts, or for its listener.

#include <filesystem>
#include <memory>
#include <string>

#include "apps/command.hpp"
#include "apps/console/output.hpp"
#include "core/scene/text.hpp"
#include "stream/wire/security/certificate.hpp"

namespace hertzline::app {

namespace {

constexpr const char* keys_examples =
    "Makes NAME.key, for the other side, and NAME.key_secret, which you keep to yourself. Existing files "
    "are not overwritten. czmq and pyzmq (zmq.auth.load_certificate) read both.\n"
    "Examples:\n"
    "  hertzline keys laboratory\n"
    "  hertzline keys alice\n"
    "  hertzline stream paper-stream --bind \"tcp://*:5573\" --curve-key laboratory.key_secret "
    "--allow-clients "
    "alice.key\n"
    "  hertzline listen --connect tcp://HOST:5573 --curve-key alice.key_secret --server-key laboratory.key";

struct KeysOptions {
    std::string name;
    Format format = Format::text;
};

Exit keys(const KeysOptions& options) {
    const std::filesystem::path file = std::filesystem::path(options.name).filename();
    if (file.empty() || file == "." || file == "..") {
        throw WrongUse("NAME: found " + quoted_briefly(options.name) +
                       ", allowed: the name of two files, without their endings .key and .key_secret");
    }
    const stream::KeyPair pair = stream::make_key_pair();
    const stream::KeyFiles files = stream::write_key_files(options.name, pair);
    Json summary;
    summary["public_file"] = files.public_file.string();
    summary["secret_file"] = files.secret_file.string();
    summary["public_key"] = stream::z85(pair.public_key);
    print_summary(summary, options.format);
    return Exit::done;
}

}  // namespace

Run keys_command(CLI::App& app) {
    auto options = std::make_shared<KeysOptions>();
    app.add_option("NAME", options->name, "name of the two files, with or without a folder")->required();
    add_format_option(app, options->format, "print the summary as one JSON object");
    app.footer(keys_examples);
    return [options] { return keys(*options); };
}

}  // namespace hertzline::app
