#pragma once
// Ends of a chain.

#include "core/scene/scene.hpp"

namespace hertzline::test {

/// One of that kind, else as by default.
inline End end_of(EndKind kind) {
    End end;
    end.kind = kind;
    return end;
}

}  // namespace hertzline::test
