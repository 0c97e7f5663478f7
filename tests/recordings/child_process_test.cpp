#include "recordings/child_process.hpp"

#include <array>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <unistd.h>

#include "tests/support/error_of.hpp"
#include "tests/support/sanitized.hpp"

namespace hertzline::test {

using namespace recordings;

namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

void answer(Answers& answers, std::int64_t number) {
    answers.write(std::as_bytes(std::span(&number, 1)));
}

/// Reads the next answer; -1 when the read was interrupted.
std::int64_t next_answer(ChildProcess& child) {
    std::int64_t number = 0;
    return child.read(std::as_writable_bytes(std::span(&number, 1))) ? number : -1;
}

std::string error_of_child(const ChildProcess::Work& work, const ChildLimits& limits = {}) {
    return error_of([&] {
        ChildProcess child(work, limits);
        next_answer(child);
    });
}

[[noreturn]] void say_nothing() {
    for (;;) {
        ::pause();
    }
}

TEST(ChildProcess, AnswersArriveInOrderHoweverMany) {
    constexpr std::int64_t many = repeated(200'000);  // more than a pipe holds
    ChildProcess child(
        [](Answers& answers) {
            for (std::int64_t i = 0; i < many; ++i) {
                answer(answers, i);
            }
        },
        {});
    for (std::int64_t i = 0; i < many; ++i) {
        ASSERT_EQ(next_answer(child), i);
    }
    EXPECT_THAT(error_of([&] { next_answer(child); }), HasSubstr("ended in the midst, with exit status 0"));
}

TEST(ChildProcess, LeavesNoCoreDump) {
    ChildProcess child([](Answers& answers) { answer(answers, ::prctl(PR_GET_DUMPABLE)); }, {});
    EXPECT_EQ(next_answer(child), 0);
}

TEST(ChildProcess, WhatEndedItIsTold) {
    for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGKILL}) {
        EXPECT_THAT(error_of_child([signal](Answers&) { ::raise(signal); }),
                    HasSubstr(std::string("crashed: ") + ::sigdescr_np(signal)));
    }
    EXPECT_THAT(error_of_child([](Answers&) { throw std::runtime_error("nobody catches it"); }),
                HasSubstr("exit status 1"));
}

TEST(ChildProcess, AnEndlessLoopIsEnded) {
    const auto loop = [](Answers&) {
        for (;;) {
            std::clock();
        }
    };
    EXPECT_THAT(error_of_child(loop, {.processor = 1s}), HasSubstr("took more than 1 s"));
}

TEST(ChildProcess, ProcessorTimeBeginsAnewWithEachAnswer) {
    ChildProcess child(
        [](Answers& answers) {
            for (std::int64_t i = 0; i < 3; ++i) {
                for (const auto begin = std::clock(); std::clock() - begin < 4 * CLOCKS_PER_SEC / 5;) {
                }
                answer(answers, i);
            }
        },
        {.processor = 1s});
    for (std::int64_t i = 0; i < 3; ++i) {
        EXPECT_EQ(next_answer(child), i);
    }
}

TEST(ChildProcess, SilenceIsBounded) {
    EXPECT_THAT(error_of_child([](Answers&) { say_nothing(); }, {.silence = 100ms}),
                HasSubstr("has been silent for 100 ms"));
}

TEST(ChildProcess, MemoryIsBounded) {
    if (sanitized) {
        GTEST_SKIP() << "a sanitizer ends the process itself";
    }
    ChildProcess child(
        [](Answers& answers) {
            void* const fits = std::malloc(std::size_t{16} << 20);
            void* const exceeds = std::malloc(std::size_t{256} << 20);
            answer(answers, (fits != nullptr ? 1 : 0) + (exceeds != nullptr ? 2 : 0));
        },
        {.memory_bytes = 128.0 * 1024 * 1024});
    EXPECT_EQ(next_answer(child), 1);
}

TEST(ChildProcess, NothingOfItsParentIsOpen) {
    const std::ifstream open_in_parent("/proc/self/status");
    const auto count = [](Answers& answers) {
        const std::filesystem::directory_iterator descriptors("/proc/self/fd");
        answer(answers, std::distance(begin(descriptors), end(descriptors)));
    };
    ChildProcess child(count, {});
    EXPECT_EQ(next_answer(child), 3 + 1 + 1);  // standard streams, the pipe, the folder itself
}

TEST(ChildProcess, SignalsOfTheTerminalAreLeftToItsParent) {
    ChildProcess child(
        [](Answers& answers) {
            for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
                ::raise(signal);
            }
            answer(answers, 1);
        },
        {});
    EXPECT_EQ(next_answer(child), 1);
}

TEST(ChildProcess, AReadThatWaitsCanBeInterrupted) {
    ChildProcess child([](Answers&) { say_nothing(); }, {.silence = std::nullopt});
    std::jthread other([&] {
        std::this_thread::sleep_for(20ms);
        child.interrupt();
    });
    EXPECT_EQ(next_answer(child), -1);
}

bool has_ended(std::int64_t process) {
    std::ifstream status("/proc/" + std::to_string(process) + "/stat");
    std::string number, name, state;
    return !(status >> number >> name >> state) || state == "Z";  // a zombie, if no process collects it here
}

TEST(ChildProcess, EndsAfterItsParentWhateverItWaitsFor) {
    std::int64_t grandchild = 0;
    {
        ChildProcess parent(
            [](Answers& answers) {
                ChildProcess child(
                    [](Answers& own) {
                        answer(own, ::getpid());
                        say_nothing();
                    },
                    {});
                answer(answers, next_answer(child));
                say_nothing();
            },
            {});
        grandchild = next_answer(parent);
        EXPECT_FALSE(has_ended(grandchild));
    }  // killed
    int waited = 0;
    while (!has_ended(grandchild) && ++waited < 600) {
        std::this_thread::sleep_for(100ms);
    }
    EXPECT_TRUE(has_ended(grandchild));
}

TEST(ChildProcess, OutlivesTheThreadThatMadeIt) {
    std::unique_ptr<ChildProcess> child;
    std::jthread([&] {
        child = std::make_unique<ChildProcess>(
            [](Answers& answers) {
                answer(answers, 1);
                std::this_thread::sleep_for(300ms);
                answer(answers, 2);
            },
            ChildLimits{});
        EXPECT_EQ(next_answer(*child), 1);
    }).join();
    EXPECT_EQ(next_answer(*child), 2);
}

}  // namespace

}  // namespace hertzline::test
