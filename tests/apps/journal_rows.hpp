#pragma once
// The journal of a program that is running.

#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "studies/database.hpp"
#include "tests/support/sockets.hpp"

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

/// Waits until the journal has `rows` rows.
inline void wait_for_rows(const std::string& journal, std::int64_t rows = 50) {
    EXPECT_TRUE(eventually([&] { return rows_of_journal(journal) >= rows; })) << "no rows in " << journal;
}

}  // namespace hertzline::test
