// The program that mpirun starts: a sweep on all ranks. It is a program of its own, so that hertzline needs no MPI.

#include "apps/commands/sweep/sweep.hpp"
#include "apps/console/messages.hpp"
#include "apps/mpi/rank_crew.hpp"
#include "apps/mpi/rank_worker.hpp"
#include "apps/mpi/ranks.hpp"
#include "apps/program.hpp"

namespace {

constexpr const char* examples =
    "Every rank takes part with --jobs threads (default: 1), the first one too. It alone reads files, keeps "
    "the "
    "journal and writes the table.\n"
    "Examples:\n"
    "  mpirun -n 64 hertzline-mpi sweep paper-wall --vary chain.preload_n=0.01..2:log:100000 -o s.h5\n"
    "  mpirun -n 4 --map-by node --bind-to none hertzline-mpi sweep my-scene.toml --points p.csv --jobs 16 "
    "-o s.h5\n"
    "Exit status: 0 done, 1 failed, 2 wrong use or wrong scene.";

/// Rank 0, whose command line counts.
hertzline::app::Exit lead(hertzline::app::Ranks& ranks, int argc, char** argv) {
    using namespace hertzline::app;
    RankCrew crew(ranks);
    const Program program{"hertzline-mpi",
                          "sweeps of hertzline on all ranks of an MPI job",
                          examples,
                          {{"sweep", "vary keys of a scene: simulate each point, to a table",
                            [&crew](CLI::App& app) { return add_sweep(app, crew); }}}};
    const Exit exit = run_program(program, argc, argv);
    finish_messages();
    crew.dismiss(exit);
    return exit;
}

}  // namespace

int main(int argc, char** argv) {
    using namespace hertzline::app;
    prepare_process();
    Ranks ranks;
    if (ranks.rank() != 0) {
        serve(ranks);
        return 0;
    }
    return static_cast<int>(lead(ranks, argc, argv));
}
