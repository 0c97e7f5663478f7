#include "recordings/formats/hdf5/hdf5.hpp"

#include <array>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include "tests/support/error_of.hpp"
#include "tests/support/recordings.hpp"
#include "tests/support/temporary_folder.hpp"

namespace hertzline {

using namespace recordings;
namespace {
using testing::HasSubstr;

class Hdf5 : public testing::Test {
protected:
    test::TemporaryFolder folder;
    std::string file = folder.file("a.h5");
    RecordingHead head = test::recording_head(NumberType::float64, 1);

    void record(const std::vector<RecordedRows>& rows) const {
        const auto writer = open_hdf5_writer(file, head);
        test::write_rows(*writer, rows);
        writer->commit();
    }
    std::string refusal() const {
        return test::error_of([&] { test::read_rows(*open_hdf5_reader(file)); });
    }
    /// Changes the file with the library itself.
    void change(const std::function<void(hid_t)>& work) const {
        const hid_t id = H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
        ASSERT_GE(id, 0);
        work(id);
        ASSERT_GE(H5Fclose(id), 0);
    }
};

TEST_F(Hdf5, RowsLongerThanAChunkRoundTrip) {
    head = test::recording_head(NumberType::float64, 40'000);
    const std::vector<RecordedRows> rows{test::recorded_rows(head, 0, 3)};
    record(rows);
    const auto reader = open_hdf5_reader(file);
    EXPECT_EQ(reader->head().columns, head.columns);
    EXPECT_TRUE(test::read_rows(*reader).at(0).values == rows[0].values);
    // 1.9 MB of samples, 2.7 MB of names: the chunks fit the rows
    EXPECT_LT(std::filesystem::file_size(file), 5'000'000);
}

TEST_F(Hdf5, OneSphereIsStillARowForEachSample) {
    record({test::recorded_rows(head, 0, 3)});
    change([](hid_t id) {
        const hid_t chain = H5Dopen2(id, "v_chain", H5P_DEFAULT);
        const hid_t space = H5Dget_space(chain);
        EXPECT_EQ(H5Sget_simple_extent_ndims(space), 2);
        H5Sclose(space);
        H5Dclose(chain);
    });
}

TEST_F(Hdf5, ThousandsOfGapsRoundTrip) {
    std::vector<RecordedRows> rows;
    for (std::int64_t i = 0; i < 3000; ++i) {
        rows.push_back(test::recorded_rows(head, 2 * i, 1));
    }
    record(rows);
    const auto read = test::read_rows(*open_hdf5_reader(file));
    ASSERT_EQ(read.size(), rows.size());
    EXPECT_EQ(read.back().first, rows.back().first);
}

TEST_F(Hdf5, LongProvenanceRoundTrips) {
    head.provenance["scene"] = std::string(200'000, 's');
    record({});
    EXPECT_EQ(open_hdf5_reader(file)->head().provenance, head.provenance);
}

TEST_F(Hdf5, WritersInSeveralThreadsWaitForOneAnother) {
    constexpr int many = 4;
    const auto name = [this](int i) { return folder.file(std::to_string(i) + ".h5"); };
    const auto rows = [this](int i) { return test::recorded_rows(head, i, 2000); };
    {
        std::vector<std::jthread> threads;
        for (int i = 0; i < many; ++i) {
            threads.emplace_back([&, i] {
                for (int k = 0; k < 10; ++k) {
                    const auto writer = open_hdf5_writer(name(i), head);
                    test::write_rows(*writer, {rows(i)});
                    if (k % 3 == 0) {
                        writer->commit();
                    }  // else given up
                }
            });
        }
    }
    for (int i = 0; i < many; ++i) {
        EXPECT_TRUE(test::read_rows(*open_hdf5_reader(name(i))).at(0).values == rows(i).values);
    }
}

TEST_F(Hdf5, AsManyRowsAsFillSeveralLevelsOfATree) {
    head = test::recording_head({"v"}, 1e6);
    const std::vector<RecordedRows> rows{
        test::recorded_rows(head, 0, 2'000'000)};  // 123 chunks, 64 in a node
    record(rows);
    EXPECT_TRUE(test::read_rows(*open_hdf5_reader(file)).at(0).values == rows[0].values);
}

/// A type and properties of the file's own: with the library's names of them the test would have a copy of the
/// variables behind the names, and the recordings, which load the library, the empty original.
struct Taken {
    explicit Taken(hid_t file) : dataset(H5Dopen2(file, "v_last", H5P_DEFAULT)) {}
    ~Taken() {
        H5Pclose(properties);
        H5Tclose(type);
        H5Dclose(dataset);
    }
    Taken(const Taken&) = delete;
    Taken& operator=(const Taken&) = delete;

    hid_t dataset;
    hid_t type = H5Dget_type(dataset);
    hid_t properties = H5Dget_create_plist(dataset);
};

TEST_F(Hdf5, OtherAttributesAndDatasetsDoNotMatter) {
    const RecordedRows rows = test::recorded_rows(head, 0, 100);
    record({rows});
    change([](hid_t id) {
        const Taken like(id);
        const hid_t one = H5Screate(H5S_SCALAR);
        for (int i = 0; i < 300; ++i) {
            const std::string name = "other" + std::to_string(i);
            H5Aclose(H5Acreate2(id, name.c_str(), like.type, one, H5P_DEFAULT, H5P_DEFAULT));
            H5Dclose(H5Dcreate2(id, name.c_str(), like.type, one, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
        }
        H5Gclose(H5Gcreate2(id, "group", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
        H5Sclose(one);
    });
    EXPECT_TRUE(test::read_rows(*open_hdf5_reader(file)).at(0).values == rows.values);
}

/// Bytes of a key in the tree at that byte: of names, or of chunks in so many dimensions.
std::size_t key_bytes_of(const std::string& bytes, std::size_t tree) {
    constexpr std::size_t of_names = 8;
    // Of chunks the first key ends with zeros for the dimensions; then the first address follows.
    std::size_t end = tree + 24 + 8;
    while (bytes.substr(end, 8) == std::string(8, '\0')) {
        end += 8;
    }
    return bytes[tree + 4] == 0 ? of_names : end - tree - 24;
}

TEST_F(Hdf5, StructuresThatLeadBackToThemselvesAreRefused) {
    record({test::recorded_rows(head, 0, 100)});
    std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
    const std::string good((std::istreambuf_iterator<char>(bytes)), {});
    int trees = 0;
    for (std::size_t at = good.find("TREE"); at != std::string::npos;
         at = good.find("TREE", at + 1), ++trees) {
        std::string bad = good;
        bad[at + 5] = 1;  // an inner node
        const std::size_t key_bytes = key_bytes_of(good, at);
        for (std::size_t i = 0; i < 8; ++i) {
            bad[at + 24 + key_bytes + i] = static_cast<char>(at >> 8 * i);
        }
        bytes.seekp(0);
        bytes << bad << std::flush;
        EXPECT_THAT(refusal(), HasSubstr("larger than the file")) << "the tree at byte " << at;
    }
    EXPECT_GT(trees, 4);
}

TEST_F(Hdf5, OtherFormsOfHdf5AreRefused) {
    record({test::recorded_rows(head, 0, 100)});
    hid_t newest = -1;
    change([&](hid_t id) {
        const Taken like(id);
        H5Ldelete(id, "v_out", H5P_DEFAULT);
        const hsize_t size = 100;
        const hid_t space = H5Screate_simple(1, &size, nullptr);
        H5Pset_chunk(like.properties, 1, &size);
        H5Pset_deflate(like.properties, 1);
        H5Dclose(H5Dcreate2(id, "v_out", like.type, space, H5P_DEFAULT, like.properties, H5P_DEFAULT));
        H5Sclose(space);
        newest = H5Fget_access_plist(id);
    });
    EXPECT_THAT(refusal(), HasSubstr("dataset v_out: allowed: chunks without filters"));
    H5Pset_libver_bounds(newest, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
    ASSERT_GE(H5Fclose(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, newest)), 0);
    H5Pclose(newest);
    EXPECT_THAT(refusal(), HasSubstr("found no superblock of version 0"));
}

TEST_F(Hdf5, NothingIsReadThatTheFileDoesNotHoldItself) {
    const RecordedRows rows = test::recorded_rows(head, 0, 100);
    record({rows});
    std::filesystem::copy_file(file, folder.file("b.h5"));
    change([&](hid_t id) {
        H5Ldelete(id, "v_out", H5P_DEFAULT);
        H5Lcreate_soft("v_last", id, "v_out", H5P_DEFAULT, H5P_DEFAULT);
    });
    EXPECT_THAT(refusal(), HasSubstr("dataset v_out: missing"));
    change([&](hid_t id) {
        H5Ldelete(id, "v_out", H5P_DEFAULT);
        H5Lcreate_external(folder.file("b.h5").c_str(), "v_out", id, "v_out", H5P_DEFAULT, H5P_DEFAULT);
    });
    EXPECT_THAT(refusal(), HasSubstr("a newer form of HDF5"));
    record({rows});
    change([](hid_t id) {  // longer than the written rows
        for (const char* name : {"v_out", "v_last", "v_chain", "x_chain"}) {
            const hid_t dataset = H5Dopen2(id, name, H5P_DEFAULT);
            const std::array<hsize_t, 2> size{1'000'000, 1};
            H5Dset_extent(dataset, size.data());
            H5Dclose(dataset);
        }
    });
    EXPECT_THAT(refusal(), HasSubstr("chunks are there"));
}

TEST_F(Hdf5, DatasetsThatDoNotFitTogetherAreRefused) {
    record({test::recorded_rows(head, 0, 100)});
    change([](hid_t id) {
        const hid_t dataset = H5Dopen2(id, "v_out", H5P_DEFAULT);
        const hsize_t size = 99;
        H5Dset_extent(dataset, &size);
        H5Dclose(dataset);
    });
    EXPECT_THAT(refusal(), HasSubstr("dataset v_out: found 99 rows, the others have 100"));
    record({test::recorded_rows(head, 0, 100)});
    change([](hid_t id) { H5Adelete(id, "columns"); });
    EXPECT_THAT(refusal(), testing::StartsWith("cannot read " + file + ": "));
}

}  // namespace
}  // namespace hertzline
