#include "recordings/formats/hdf5/hdf5_file.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

namespace hertzline::recordings {

namespace {

using namespace std::string_view_literals;

constexpr std::uint64_t max_structure_bytes = std::uint64_t{256}
                                              << 20;  // a million spheres' columns, and more
constexpr std::uint64_t max_chunk_bytes = std::uint64_t{16} << 20;
constexpr std::uint64_t max_rows = std::uint64_t{1} << 62;
constexpr std::uint64_t undefined_address = ~std::uint64_t{0};

// Types of messages in an object header.
constexpr std::uint64_t dataspace_message = 0x01;
constexpr std::uint64_t datatype_message = 0x03;
constexpr std::uint64_t layout_message = 0x08;
constexpr std::uint64_t filters_message = 0x0b;
constexpr std::uint64_t attribute_message = 0x0c;
constexpr std::uint64_t continuation_message = 0x10;
constexpr std::uint64_t symbol_table_message = 0x11;

constexpr unsigned tree_of_names = 0;
constexpr unsigned tree_of_chunks = 1;

[[noreturn]] void refuse(const std::string& reason) {
    throw std::runtime_error(reason);
}

/// Takes the fields of a structure one after the other.
class Fields {
public:
    explicit Fields(std::string_view bytes) : bytes_(bytes) {}

    std::size_t left() const noexcept { return bytes_.size(); }

    std::string_view bytes(std::uint64_t size) {
        if (size > bytes_.size()) {
            refuse("damaged: a structure ends too early");
        }
        const std::string_view taken = bytes_.substr(0, size);
        bytes_.remove_prefix(size);
        return taken;
    }

    /// Takes an integer of that many bytes, little-endian.
    std::uint64_t number(std::size_t size) {
        std::uint64_t number = 0;
        const std::string_view taken = bytes(size);
        for (std::size_t i = 0; i < size; ++i) {
            number |= std::uint64_t{static_cast<unsigned char>(taken[i])} << 8 * i;
        }
        return number;
    }

    std::uint64_t address() { return number(8); }

    /// Takes bytes that say which structure this is.
    void expect(std::string_view signature, std::string_view structure) {
        if (bytes(signature.size()) != signature) {
            refuse(fmt::format("damaged, or of another program: found no {}", structure));
        }
    }

private:
    std::string_view bytes_;
};

/// Classes of types.
constexpr unsigned integer_class = 0;
constexpr unsigned floating_class = 1;
constexpr unsigned text_class = 3;
constexpr unsigned variable_length_class = 9;

/// The beginning of a message that describes a type.
struct TypeHead {
    explicit TypeHead(Fields& fields)
        : kind(static_cast<unsigned>(fields.number(1)) & 0xf),
          bits(fields.number(3)),
          bytes(fields.number(4)) {}

    unsigned kind;  ///< its class
    std::uint64_t bits;
    std::uint64_t bytes;
};

/// Returns the type of numbers; nothing for other types, and numbers that no processor has.
std::optional<FileNumber> number_type(std::string_view message) {
    /// Places and lengths of exponent and fraction, and the exponent's bias, as IEEE 754 has them.
    struct Floating {
        std::uint64_t bytes;
        std::array<std::uint64_t, 5> form;
    };
    constexpr std::array forms{Floating{2, {10, 5, 0, 10, 15}}, Floating{4, {23, 8, 0, 23, 127}},
                               Floating{8, {52, 11, 0, 52, 1023}}};
    Fields fields(message);
    const TypeHead head(fields);
    if (head.kind != integer_class && head.kind != floating_class) {
        return std::nullopt;
    }
    FileNumber type{FileNumber::Kind::floating, head.bytes,
                    (head.bits & 1) != 0 ? std::endian::big : std::endian::little};
    const bool fills_its_bytes = fields.number(2) == 0 && fields.number(2) == 8 * head.bytes;
    bool is_usual = fills_its_bytes;
    if (head.kind == integer_class) {
        type.kind = (head.bits & 8) != 0 ? FileNumber::Kind::integer : FileNumber::Kind::natural;
    } else {
        const std::array<std::uint64_t, 5> form{fields.number(1), fields.number(1), fields.number(1),
                                                fields.number(1), fields.number(4)};
        const auto* const known = std::ranges::find(forms, head.bytes, &Floating::bytes);
        is_usual = fills_its_bytes && known != forms.end() && known->form == form;
    }
    return is_usual && is_known(type) ? std::optional(type) : std::nullopt;
}

/// Returns the lengths of all dimensions. Versions 1 and 2.
std::vector<std::uint64_t> dimensions_of(std::string_view space) {
    Fields fields(space);
    const std::uint64_t version = fields.number(1);
    const std::uint64_t rank = fields.number(1);
    fields.bytes(version == 1 ? 6 : 2);  // flags; in version 2 the kind
    constexpr std::uint64_t most = 32;
    if (version < 1 || version > 2 || rank > most) {
        refuse(fmt::format("found a dataspace of version {} with {} dimensions", version, rank));
    }
    std::vector<std::uint64_t> dimensions;
    for (std::uint64_t i = 0; i < rank; ++i) {
        dimensions.push_back(fields.number(8));
    }
    return dimensions;
}

constexpr std::uint64_t padded(std::uint64_t size) {
    return (size + 7) / 8 * 8;
}

constexpr std::uint64_t pieces(std::uint64_t size, std::uint64_t piece) {
    return size / piece + (size % piece != 0);
}

}  // namespace

Hdf5File::Hdf5File(InputFile file) : file_(std::move(file)), structures_left_(4 * file_.size()) {
    constexpr std::uint64_t superblock_bytes = 96;
    if (file_.size() < superblock_bytes) {
        refuse("cut short: it has no superblock");
    }
    const std::string superblock = structure(0, superblock_bytes);
    Fields fields(superblock);
    fields.expect("\x89HDF\r\n\x1a\n"sv, "signature of HDF5");
    fields.expect("\0\0\0\0\0\x08\x08\0"sv, "superblock of version 0");
    fields.bytes(8);  // sizes of nodes, flags
    const std::uint64_t base = fields.address();
    fields.address();  // of free space
    const std::uint64_t end = fields.address();
    fields.address();  // of a driver's description
    fields.address();  // of the root's name
    if (base != 0) {
        refuse(fmt::format("found contents from byte {} on, allowed: from 0", base));
    }
    if (end > file_.size()) {
        refuse(fmt::format("cut short: {} bytes by its superblock, {} in the file", end, file_.size()));
    }
    root_ = messages_of(fields.address());
    list_members();
}

/// Structures lie side by side. So they have no more bytes than the file, unless they lead back to themselves.
std::string Hdf5File::structure(std::uint64_t address, std::uint64_t size) {
    if (size > file_.size() || address > file_.size() - size) {
        refuse(fmt::format("damaged: {} bytes from byte {} on, the file ends at {}", size, address,
                           file_.size()));
    }
    if (size > max_structure_bytes || size > structures_left_) {
        refuse("damaged: its structures are larger than the file");
    }
    structures_left_ -= size;
    file_.seek(address);
    return file_.text(size, "a structure");
}

std::vector<Hdf5File::Message> Hdf5File::messages_of(std::uint64_t header) {
    const std::string prefix = structure(header, 16);
    Fields fields(prefix);
    fields.expect("\1\0"sv, "object header of version 1");
    fields.bytes(6);  // numbers of messages and of references
    std::vector<Message> messages;
    std::vector<std::pair<std::uint64_t, std::uint64_t>> blocks{{header + 16, fields.number(4)}};
    while (!blocks.empty()) {
        const auto [address, size] = blocks.back();
        blocks.pop_back();
        const std::string bytes = structure(address, size);
        Fields block(bytes);
        while (block.left() >= 8) {
            const std::uint64_t type = block.number(2);
            const std::uint64_t message_bytes = block.number(2);
            block.bytes(4);  // flags
            Fields message(block.bytes(message_bytes));
            if (type == continuation_message) {
                const std::uint64_t next = message.address();
                blocks.emplace_back(next, message.number(8));
            } else {
                messages.push_back({type, std::string(message.bytes(message_bytes))});
            }
        }
    }
    return messages;
}

/// Returns the keys and the addresses of a tree's leaves.
std::vector<std::pair<std::string, std::uint64_t>> Hdf5File::entries_of_tree(std::uint64_t root,
                                                                             unsigned type,
                                                                             std::size_t key_bytes) {
    constexpr std::uint64_t head_bytes = 24;
    std::vector<std::pair<std::string, std::uint64_t>> leaves;
    std::vector<std::uint64_t> nodes{root};
    while (!nodes.empty()) {
        const std::uint64_t address = nodes.back();
        nodes.pop_back();
        const std::string prefix = structure(address, head_bytes);
        Fields head(prefix);
        head.expect("TREE"sv, "B-tree");
        if (head.number(1) != type) {
            refuse("damaged: a B-tree of another kind");
        }
        const bool is_leaf = head.number(1) == 0;
        const std::uint64_t count = head.number(2);
        const std::string bytes = structure(address + head_bytes, count * (key_bytes + 8));
        Fields entries(bytes);
        for (std::uint64_t i = 0; i < count; ++i) {
            const std::string_view key = entries.bytes(key_bytes);
            const std::uint64_t child = entries.address();
            if (is_leaf) {
                leaves.emplace_back(key, child);
            } else {
                nodes.push_back(child);
            }
        }
    }
    return leaves;
}

void Hdf5File::list_members() {
    const auto table = std::ranges::find(root_, symbol_table_message, &Message::type);
    if (table == root_.end()) {
        refuse("the root has no symbol table: a newer form of HDF5, which another program has written");
    }
    Fields fields(table->bytes);
    const std::uint64_t tree = fields.address();
    const std::string heap = structure(fields.address(), 32);
    Fields heap_fields(heap);
    heap_fields.expect("HEAP\0\0\0\0"sv, "local heap of version 0");
    const std::uint64_t names_bytes = heap_fields.number(8);
    heap_fields.address();  // of free space
    const std::string names = structure(heap_fields.address(), names_bytes);
    for (const auto& [key, node] : entries_of_tree(tree, tree_of_names, 8)) {
        const std::string prefix = structure(node, 8);
        Fields head(prefix);
        head.expect("SNOD\1\0"sv, "node of names");
        constexpr std::uint64_t entry_bytes = 40;
        const std::uint64_t count = head.number(2);
        const std::string bytes = structure(node + 8, count * entry_bytes);
        Fields entries(bytes);
        for (std::uint64_t i = 0; i < count; ++i) {
            Fields entry(entries.bytes(entry_bytes));
            const std::uint64_t name = entry.number(8);
            const std::uint64_t header = entry.address();
            if (name < names.size() && header != undefined_address) {  // else a link
                members_[names.substr(name, names.find('\0', name) - name)] = header;
            }
        }
    }
}

Hdf5File::Attribute Hdf5File::attribute(const std::string& name) {
    for (const Message& message : root_) {
        if (message.type != attribute_message) {
            continue;
        }
        Fields fields(message.bytes);
        const std::uint64_t version = fields.number(1);
        const std::uint64_t flags = fields.number(1);
        const std::uint64_t name_bytes = fields.number(2);
        const std::uint64_t type_bytes = fields.number(2);
        const std::uint64_t space_bytes = fields.number(2);
        fields.bytes(version == 3 ? 1 : 0);  // the name's character set
        const auto part = [&](std::uint64_t size) {
            return fields.bytes(version == 1 ? padded(size) : size);
        };
        const std::string_view its_name = part(name_bytes);
        if (its_name.substr(0, its_name.find('\0')) != name) {
            continue;
        }
        if (version < 1 || version > 3 || (version > 1 && flags != 0)) {
            refuse(fmt::format("attribute {}: of a form that is not read", name));
        }
        const std::string_view type = part(type_bytes);
        const auto dimensions = dimensions_of(part(space_bytes));
        if (std::ranges::any_of(dimensions, [](std::uint64_t length) { return length != 1; })) {
            refuse(fmt::format("attribute {}: found several values, allowed: one", name));
        }
        return {std::string(type), std::string(fields.bytes(fields.left()))};
    }
    refuse(fmt::format("attribute {} is missing", name));
}

double Hdf5File::number(const std::string& name) {
    const Attribute found = attribute(name);
    const auto type = number_type(found.type);
    if (!type) {
        refuse(fmt::format("attribute {} is not a number", name));
    }
    Fields fields(found.data);
    return number_in(*type, std::as_bytes(std::span(fields.bytes(type->bytes))));
}

std::string Hdf5File::text(const std::string& name) {
    const Attribute found = attribute(name);
    Fields type(found.type);
    Fields fields(found.data);
    const TypeHead head(type);
    if (head.kind == text_class) {
        const std::string_view padding = (head.bits & 0xf) == 2 ? " "sv : "\0"sv;
        const std::string_view text = fields.bytes(head.bytes);
        return std::string((head.bits & 0xf) == 0 ? text.substr(0, text.find('\0'))
                                                  : text.substr(0, text.find_last_not_of(padding) + 1));
    }
    if (head.kind != variable_length_class || (head.bits & 0xf) != 1) {
        refuse(fmt::format("attribute {} is not a string", name));
    }
    const std::uint64_t length = fields.number(4);
    const std::uint64_t heap = fields.address();
    const std::string object = length == 0 ? "" : object_of_heap(heap, fields.number(4));
    const std::string_view text = Fields(object).bytes(length);
    return std::string(text.substr(0, text.find('\0')));
}

std::string Hdf5File::object_of_heap(std::uint64_t address, std::uint64_t index) {
    constexpr std::uint64_t head_bytes = 16;
    const std::string prefix = structure(address, head_bytes);
    Fields head(prefix);
    head.expect("GCOL\1\0\0\0"sv, "global heap");
    const std::uint64_t size = head.number(8);
    const std::string bytes = structure(address + head_bytes, std::max(size, head_bytes) - head_bytes);
    Fields objects(bytes);
    while (objects.left() >= head_bytes) {
        const std::uint64_t its_index = objects.number(2);
        objects.bytes(6);  // number of references
        const std::uint64_t its_bytes = objects.number(8);
        if (its_index == index) {
            return std::string(objects.bytes(its_bytes));
        }
        if (its_index == 0) {  // free space
            break;
        }
        objects.bytes(its_bytes);
        objects.bytes(std::min<std::uint64_t>(padded(its_bytes) - its_bytes, objects.left()));
    }
    refuse(fmt::format("damaged: object {} of a global heap is missing", index));
}

Hdf5Dataset Hdf5File::dataset(const std::string& name, int rank, std::uint64_t columns) {
    const auto member = members_.find(name);
    if (member == members_.end()) {
        refuse(fmt::format("dataset {}: missing", name));
    }
    const std::vector<Message> messages = messages_of(member->second);
    const auto message = [&](std::uint64_t type) {
        const auto found = std::ranges::find(messages, type, &Message::type);
        return found != messages.end() ? std::string_view(found->bytes) : std::string_view();
    };
    const auto refuse_it = [&name](const std::string& reason) {
        refuse(fmt::format("dataset {}: {}", name, reason));
    };
    Hdf5Dataset dataset;
    dataset.columns = columns;
    const auto type = number_type(message(datatype_message));
    if (!type) {
        refuse_it("its numbers are of an unknown type");
    }
    dataset.numbers = *type;
    const auto dimensions = dimensions_of(message(dataspace_message));
    if (dimensions.size() != static_cast<std::size_t>(rank) || (rank == 2 && dimensions[1] != columns)) {
        refuse_it(fmt::format("allowed: {} dimensions and {} columns", rank, columns));
    }
    dataset.rows = dimensions[0];

    Fields layout(message(layout_message));
    constexpr std::string_view in_one_piece = "\3\1"sv;  // version, class
    constexpr std::string_view chunked = "\3\2"sv;
    const std::string_view form = layout.left() >= 2 ? layout.bytes(2) : "";
    if (form == in_one_piece) {
        const std::uint64_t address = layout.address();
        take_piece(dataset, address, layout.number(8));
        return dataset;
    }
    if (!message(filters_message).empty() || form != chunked ||
        layout.number(1) != static_cast<unsigned>(rank) + 1) {
        refuse_it("allowed: chunks without filters, or a single piece");
    }
    const std::uint64_t tree = layout.address();
    dataset.chunk = {layout.number(4), rank == 2 ? layout.number(4) : 1};
    const std::uint64_t most = max_chunk_bytes / dataset.numbers.bytes;
    if (dataset.chunk[0] == 0 || dataset.chunk[1] == 0 || dataset.chunk[0] > most ||
        dataset.chunk[1] > most / dataset.chunk[0] || layout.number(4) != dataset.numbers.bytes) {
        refuse_it(fmt::format("found chunks of {} x {}, allowed: 1 number to {} bytes", dataset.chunk[0],
                              dataset.chunk[1], max_chunk_bytes));
    }
    try {
        find_chunks(dataset, rank, tree);
    } catch (const std::runtime_error& error) {
        refuse_it(error.what());
    }
    return dataset;
}

/// Takes the place of a dataset whose rows follow one another.
void Hdf5File::take_piece(Hdf5Dataset& dataset, std::uint64_t address, std::uint64_t bytes) const {
    const std::uint64_t row_bytes = dataset.columns * dataset.numbers.bytes;
    const bool fits = dataset.rows == 0 || (row_bytes > 0 && dataset.rows <= file_.size() / row_bytes &&
                                            bytes >= dataset.rows * row_bytes &&
                                            address <= file_.size() - dataset.rows * row_bytes);
    if (!fits) {
        refuse(fmt::format("damaged: {} rows at byte {}, the file ends at {}", dataset.rows, address,
                           file_.size()));
    }
    dataset.chunk = {std::max<std::uint64_t>(1, dataset.rows), dataset.columns};
    dataset.chunks = {address};
}

void Hdf5File::find_chunks(Hdf5Dataset& dataset, int rank, std::uint64_t tree) {
    const std::uint64_t across = pieces(dataset.columns, dataset.chunk[1]);
    const std::uint64_t down = pieces(dataset.rows, dataset.chunk[0]);
    const std::uint64_t chunk_bytes = dataset.chunk[0] * dataset.chunk[1] * dataset.numbers.bytes;
    const std::uint64_t room = file_.size() / chunk_bytes;
    if (dataset.rows > max_rows || down > room / across) {
        refuse(fmt::format("damaged: at most {} of its {} x {} chunks are there", room, down, across));
    }
    dataset.chunks.assign(down * across, undefined_address);
    if (down > 0 && tree != undefined_address) {
        const std::size_t key_bytes = 8 + 8 * (static_cast<std::size_t>(rank) + 1);
        for (const auto& [key, address] : entries_of_tree(tree, tree_of_chunks, key_bytes)) {
            Fields fields(key);
            fields.bytes(8);  // size, filters that are left out
            const std::uint64_t row = fields.number(8) / dataset.chunk[0];
            const std::uint64_t column = rank == 2 ? fields.number(8) / dataset.chunk[1] : 0;
            if (row < down && column < across && address <= file_.size() - chunk_bytes) {
                dataset.chunks[row * across + column] = address;
            }
        }
    }
    const auto missing = static_cast<std::uint64_t>(std::ranges::count(dataset.chunks, undefined_address));
    if (missing > 0) {
        refuse(fmt::format("damaged: {} of its {} chunks are there", dataset.chunks.size() - missing,
                           dataset.chunks.size()));
    }
}

void Hdf5File::read(const Hdf5Dataset& dataset, std::uint64_t row, std::span<std::byte> rows) {
    const auto& [chunk_rows, chunk_columns] = dataset.chunk;
    const std::uint64_t across = pieces(dataset.columns, chunk_columns);
    const std::size_t row_bytes = dataset.columns * dataset.numbers.bytes;
    while (!rows.empty()) {
        const std::uint64_t in_chunk = row % chunk_rows;
        // Rows that fill their chunk's width follow one another in the file.
        const std::uint64_t most = chunk_columns == dataset.columns ? chunk_rows - in_chunk : 1;
        const std::uint64_t count = std::min(most, rows.size() / row_bytes);
        const std::span<std::byte> part = rows.first(count * row_bytes);
        for (std::uint64_t piece = 0, at = 0; piece < across; ++piece) {
            const std::size_t bytes =
                std::min<std::uint64_t>(chunk_columns * dataset.numbers.bytes * count, part.size() - at);
            file_.seek(dataset.chunks[row / chunk_rows * across + piece] +
                       in_chunk * chunk_columns * dataset.numbers.bytes);
            file_.read(part.subspan(at, bytes), "the rows");
            at += bytes;
        }
        rows = rows.subspan(part.size());
        row += count;
    }
}

}  // namespace hertzline::recordings
