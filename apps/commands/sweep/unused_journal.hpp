#pragma once
// A journal that is taken away again when nothing has come to it.

#include "studies/sweep/journal.hpp"

namespace hertzline::app {

/// Takes a journal away that no row has come to, where one was to come.
class UnusedJournal {
public:
    UnusedJournal(studies::Journal& journal, bool wants_rows) : journal_(journal), wants_rows_(wants_rows) {}
    ~UnusedJournal() {
        if (wants_rows_ && !journal_.has_rows()) {
            journal_.remove();
        }
    }
    UnusedJournal(const UnusedJournal&) = delete;
    UnusedJournal& operator=(const UnusedJournal&) = delete;

private:
    studies::Journal& journal_;
    bool wants_rows_;
};

}  // namespace hertzline::app
