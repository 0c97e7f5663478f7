// A journal of a sweep, as --resume and --merge read it. Where the first byte is odd checksums are put right, so that what lies behind
// them is reached.

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

#include "studies/sweep/sweep_table.hpp"
#include <boost/crc.hpp>

#include "core/scene/json.hpp"
#include "tests/fuzz/claim.hpp"
#include "tests/fuzz/memory_folder.hpp"

namespace {

using namespace hertzline;
using fuzz::claim;

constexpr std::size_t head_bytes = 24;
constexpr std::size_t row_head_bytes = 16;
constexpr std::size_t longest_message = 3000;
constexpr std::int64_t most_points = 10'000;  // more take time, and nothing else

std::uint32_t number_at(const std::string& bytes, std::size_t at) {
    std::uint32_t number = 0;
    std::memcpy(&number, bytes.data() + at, sizeof number);
    return number;
}

void put_checksum(boost::crc_32_type& crc, std::string& bytes, std::size_t at) {
    const std::uint32_t checksum = crc.checksum();
    std::memcpy(bytes.data() + at, &checksum, sizeof checksum);
}

/// Checksums of the beginning and of all rows, as journal.hpp has them.
void put_right(std::string& bytes) {
    if (bytes.size() < head_bytes) {
        return;
    }
    std::memcpy(bytes.data(), "HZSWEEP1", 8);
    const std::size_t first_row = head_bytes + number_at(bytes, 8);
    const std::size_t row_bytes = row_head_bytes + number_at(bytes, 12);
    if (first_row > bytes.size()) {
        return;
    }
    boost::crc_32_type of_head;
    of_head.process_bytes(bytes.data() + 8, 8);
    of_head.process_bytes(bytes.data() + head_bytes, first_row - head_bytes);
    put_checksum(of_head, bytes, 16);
    for (std::size_t at = first_row; at + row_bytes <= bytes.size(); at += row_bytes) {
        boost::crc_32_type of_row;
        of_row.process_bytes(bytes.data() + at, 12);
        of_row.process_bytes(bytes.data() + at + row_head_bytes, row_bytes - row_head_bytes);
        put_checksum(of_row, bytes, at + 12);
    }
}

void claim_rows(const studies::Sweep& sweep, studies::Journal& journal) {
    if (sweep.plan.size() > most_points || journal.payload_bytes() != studies::payload_bytes(sweep.demand)) {
        return;
    }
    journal.load(sweep.plan.size());
    const studies::SweepTable table(sweep, {&journal});
    for (std::int64_t point = 0; point < sweep.plan.size(); ++point) {
        if (!journal.has(point)) {
            continue;
        }
        std::vector<float> waveform;
        claim(table.row(point, &waveform).size() == table.columns().size(),
              "a row has a cell in each column");
        claim(waveform.size() == (sweep.demand.waveform ? sweep.demand.waveform_samples : 0),
              "a waveform is as long as all are");
        claim(!studies::row_json(table, point).dump(-1, ' ', false, Json::error_handler_t::replace).empty(),
              "a row is JSON");
    }
}

/// A sweep that is the same after it was written and read again, and its rows; or a fault.
void claim_journal_or_fault(const std::filesystem::path& path) {
    try {
        studies::Journal journal(path, studies::Journal::Use::read);
        const studies::Sweep sweep = studies::sweep_of_journal(journal.text());
        const std::string text = studies::journal_text(sweep);
        const studies::Sweep again = studies::sweep_of_journal(text);
        claim(studies::journal_text(again) == text, "a sweep reads back as it was written", text);
        claim(!studies::journal_difference(text, studies::journal_text(again)), "equal sweeps do not differ");
        const auto difference = studies::journal_difference(journal.text(), text);
        if (difference) {
            fuzz::claim_message(*difference, longest_message);
        }
        claim_rows(sweep, journal);
    } catch (const std::runtime_error& error) {
        fuzz::claim_message(error.what(), longest_message);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const fuzz::MemoryFolder folder;
    if (size == 0) {
        return 0;
    }
    std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
    if (data[0] % 2 == 1) {
        put_right(bytes);
    }
    folder.hold("x.journal", bytes);
    claim_journal_or_fault(folder.file("x.journal"));
    return 0;
}
