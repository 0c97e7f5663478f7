// SUNDIALS CVODE: Adams methods of variable order with a fixed-point iteration, since the chain is not stiff.

#include <cvode/cvode.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "bench/peers/sundials_run.hpp"

namespace hertzline::bench {

namespace {

class Adams {
public:
    Adams(N_Vector y, SUNContext context, void* run, CVRhsFn slope, double tolerance)
        : memory_(CVodeCreate(CV_ADAMS, context)), iteration_(SUNNonlinSol_FixedPoint(y, 0, context)) {
        checked(CVodeInit(memory_, slope, 0, y), "CVodeInit");
        checked(CVodeSetUserData(memory_, run), "CVodeSetUserData");
        checked(CVodeSStolerances(memory_, tolerance, tolerance), "CVodeSStolerances");
        checked(CVodeSetNonlinearSolver(memory_, iteration_), "CVodeSetNonlinearSolver");
        checked(CVodeSetErrFile(memory_, nullptr), "CVodeSetErrFile");
        checked(CVodeSetMaxErrTestFails(memory_, 100), "CVodeSetMaxErrTestFails");  // jumps of the dashpots
        checked(CVodeSetMaxNumSteps(memory_, 1'000'000), "CVodeSetMaxNumSteps");
    }
    Adams(const Adams&) = delete;
    Adams& operator=(const Adams&) = delete;
    ~Adams() {
        CVodeFree(&memory_);
        SUNNonlinSolFree(iteration_);
    }

    void find_roots(int count, CVRootFn values) {
        checked(CVodeRootInit(memory_, count, values), "CVodeRootInit");
        checked(CVodeSetNoInactiveRootWarn(memory_), "CVodeSetNoInactiveRootWarn");
    }
    void begin(N_Vector y) { restart(0, y); }
    void restart(double t, N_Vector y) { checked(CVodeReInit(memory_, t, y), "CVodeReInit"); }
    bool advance(double until, N_Vector y, double& t) {
        return checked(CVode(memory_, until, y, &t, CV_NORMAL), "CVode") == CV_ROOT_RETURN;
    }
    void roots(int* found) { checked(CVodeGetRootInfo(memory_, found), "CVodeGetRootInfo"); }

private:
    void* memory_;
    SUNNonlinearSolver iteration_;
};

}  // namespace

std::vector<Contender> cvode_contenders(const Problem& problem) {
    std::vector<Contender> list;
    for (const double tolerance : tolerances(1e-3)) {
        for (const Contacts contacts : {Contacts::by_overlap, Contacts::located}) {
            list.push_back(sundials_contender<Adams>(problem, "CVODE Adams", tolerance, contacts));
        }
    }
    return list;
}

}  // namespace hertzline::bench
