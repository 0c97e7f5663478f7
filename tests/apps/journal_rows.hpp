#pragma once
// The journal of a program that is running.

#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>

#include "studies/database.hpp"

namespace hertzline::test {

/// Returns the number of rows in the journal; 0 when it does not exist yet.
inline std::int64_t rows_of_journal(const std::string& journal) {
    try {
        const studies::Database database(journal, studies::Database::Use::read);
        database.wait_for_others(1000);
        return database.number("SELECT count(*) FROM points");
    } catch (const std::runtime_error&) {
        return 0;
    }
}

/// Waits until the journal has `rows` rows, but not longer than some ten seconds.
inline void wait_for_rows(const std::string& journal, std::int64_t rows = 50) {
    for (int tries = 0; rows_of_journal(journal) < rows && tries < 6000; ++tries) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
}

}  // namespace hertzline::test
