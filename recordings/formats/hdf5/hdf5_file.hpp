#pragma once
// An HDF5 file that is read without the HDF5 library: that one (1.10.8) crashes on damaged files, does not return, or asks
// for all memory. Only the structures are read with which the library stores a recording by default, and those in which other programs change one, as named in
// "HDF5 File Format Specification", version 3.0; files that use others are refused:
//
//     superblock 0 ── root: object header 1 ──┬── attributes 1 to 3: numbers, or texts in global heaps
//                                             └── symbol table: B-trees and nodes of names in a local heap
//     a dataset: object header 1 ── dataspace 1, 2, datatype 1 to 3, layout 3 ── B-tree 1 of chunks, without filters;
//                                                                               or a single piece
//
// No byte is trusted: every address is checked, and a file whose structures lead back to themselves is refused.

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "recordings/file_numbers.hpp"
#include "recordings/files/input_file.hpp"

namespace hertzline::recordings {

/// A dataset of one or two dimensions, in chunks or in one piece.
struct Hdf5Dataset {
    FileNumber numbers;
    std::uint64_t rows = 0;
    std::uint64_t columns = 0;
    std::array<std::uint64_t, 2> chunk{};  ///< rows and columns of a chunk; of all where it lies in one piece
    std::vector<std::uint64_t> chunks;     ///< addresses, [rows of chunks][columns of chunks]
};

/// Errors are std::runtime_error with the fault, without the path.
class Hdf5File {
public:
    explicit Hdf5File(InputFile file);

    /// Returns an attribute of the root that is a number of any type.
    double number(const std::string& attribute);
    /// Returns an attribute of the root that is a text, of fixed or of variable length.
    std::string text(const std::string& attribute);

    /// Whether the root has a dataset or group of that name.
    bool has(const std::string& name) const { return members_.contains(name); }
    /// Opens a dataset of the root that has all its chunks. @param rank 1: of numbers; 2: of rows of so many columns
    Hdf5Dataset dataset(const std::string& name, int rank, std::uint64_t columns);
    /// Reads rows from `row` on. @param rows whole rows, as they lie in the file
    void read(const Hdf5Dataset& dataset, std::uint64_t row, std::span<std::byte> rows);

private:
    /// A part of an object header, or of the data behind it.
    struct Message {
        std::uint64_t type;
        std::string bytes;
    };

    std::string structure(std::uint64_t address, std::uint64_t size);
    std::vector<Message> messages_of(std::uint64_t header);
    std::vector<std::pair<std::string, std::uint64_t>> entries_of_tree(std::uint64_t root, unsigned type,
                                                                       std::size_t key_bytes);
    void list_members();
    /// An attribute with a single value.
    struct Attribute {
        std::string type;  ///< the message that describes it
        std::string data;
    };
    Attribute attribute(const std::string& name);
    std::string object_of_heap(std::uint64_t address, std::uint64_t index);
    void take_piece(Hdf5Dataset& dataset, std::uint64_t address, std::uint64_t bytes) const;
    void find_chunks(Hdf5Dataset& dataset, int rank, std::uint64_t tree);

    InputFile file_;
    std::uint64_t structures_left_;  // bytes that structures may still have
    std::vector<Message> root_;
    std::map<std::string, std::uint64_t> members_;  // addresses of their object headers
};

}  // namespace hertzline::recordings
