#pragma once
// The program's allocator.

namespace hertzline::app {

/// Starts the thread that gives freed memory back to the system. Not before main(): where the address space does not hold its
/// stack, jemalloc would end the program.
void start_allocator_thread() noexcept;

}  // namespace hertzline::app
