// Writes recordings for read_recordings.py and .m, with their numbers as raw bytes: write_recordings FOLDER

#include <array>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <iterator>

#include "recordings/formats/csv/csv.hpp"
#include "recordings/formats/hdf5/hdf5.hpp"
#include "recordings/formats/npy.hpp"
#include "recordings/formats/sigmf/sigmf.hpp"
#include "recordings/formats/table.hpp"
#include "recordings/formats/wav.hpp"
#include "tests/support/recordings.hpp"

namespace {
using namespace hertzline;
using namespace hertzline::recordings;
namespace fs = std::filesystem;

template <class Number>
void write_raw(const fs::path& file, const std::vector<Number>& numbers) {
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(numbers.data()),
               static_cast<std::streamsize>(numbers.size() * sizeof(Number)));
}

/// Writes NAME.values (float64), NAME.samples (int64) and the recording in each format.
void write_all(const fs::path& folder, const std::string& name, const RecordingHead& head) {
    std::vector<double> values;
    std::vector<std::int64_t> samples;
    const auto npy = open_npy_writer(folder / (name + ".npy"), head);
    const auto hdf5 = open_hdf5_writer(folder / (name + ".h5"), head);
    const auto csv = open_csv_writer(folder / (name + ".csv"), head);
    const bool narrow = head.numbers == NumberType::float32;
    const auto sigmf = narrow ? open_sigmf_writer(folder / (name + ".sigmf-meta"), head) : nullptr;
    const auto collection =
        narrow ? open_sigmf_collection_writer(folder / (name + ".sigmf-collection"), head) : nullptr;
    const auto wav = narrow ? open_wav_writer(folder / (name + ".wav"), head) : nullptr;
    const std::array<RecordingWriter*, 6> writers{npy.get(),   hdf5.get(),       csv.get(),
                                                  sigmf.get(), collection.get(), wav.get()};
    for (const std::int64_t first : {3, 5000, 6000}) {
        const RecordedRows rows = test::recorded_rows(head, first, 1000);
        for (RecordingWriter* writer : writers) {
            if (writer != nullptr) {
                writer->write(rows.first, rows.values);
            }
        }
        values.insert(values.end(), rows.values.begin(), rows.values.end());
        for (std::int64_t i = 0; i < 1000; ++i) {
            samples.push_back(first + i);
        }
    }
    for (RecordingWriter* writer : writers) {
        if (writer != nullptr) {
            writer->commit();
        }
    }
    write_raw(folder / (name + ".values"), values);
    write_raw(folder / (name + ".samples"), samples);
}

/// Writes spectrum.csv, .npy and .h5, as read_recordings.py expects them.
void write_tables(const fs::path& folder) {
    std::vector<std::vector<double>> values(2);
    for (int i = 0; i < 300'000; ++i) {
        values[0].push_back(i / 3.0);
        values[1].push_back(1.0 / (1 + i));
    }
    const Table table = number_table({{"frequency_hz", "frequency", "Hz"}, {"f_last_n", "f_last", "N"}},
                                     std::move(values), {{"version", "1.2.3"}});
    const std::atomic<bool> stop{false};
    for (const char* name : {"spectrum.csv", "spectrum.npy", "spectrum.h5"}) {
        write_table(folder / name, table, stop);
    }
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 2) {
        std::fputs("usage: write_recordings FOLDER\n", stderr);
        return 2;
    }
    const fs::path folder = arguments[1];
    fs::remove_all(folder);
    fs::create_directories(folder);
    write_all(folder, "narrow", test::recording_head(NumberType::float32, 3));
    write_all(folder, "exact", test::recording_head(NumberType::float64, 3));
    write_all(folder, "wide", test::recording_head(NumberType::float64, 2000));
    write_tables(folder);
    return 0;
}
