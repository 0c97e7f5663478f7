#pragma once
// Ends of a chain.

#include "hertzline/scene.hpp"

namespace hertzline::test {

/// Returns an end of that kind with default values.
inline End end_of(EndKind kind) {
    End end;
    end.kind = kind;
    return end;
}

}  // namespace hertzline::test
