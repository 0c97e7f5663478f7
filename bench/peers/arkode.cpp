// SUNDIALS ARKODE, ERKStep: explicit Runge-Kutta methods of Dormand and Prince, 5(4), and Verner, 6(5).

#include <arkode/arkode_erkstep.h>

#include "bench/peers/sundials_run.hpp"

namespace hertzline::bench {

namespace {

class RungeKutta {
public:
    RungeKutta(N_Vector y, SUNContext context, void* run, ARKRhsFn slope, double tolerance,
               ARKODE_ERKTableID table)
        : slope_(slope), memory_(ERKStepCreate(slope, 0, y, context)) {
        checked(ERKStepSetUserData(memory_, run), "ERKStepSetUserData");
        checked(ERKStepSStolerances(memory_, tolerance, tolerance), "ERKStepSStolerances");
        checked(ERKStepSetTableNum(memory_, table), "ERKStepSetTableNum");
        // higher degrees, or steps that stop at the samples, take more time
        checked(ERKStepSetInterpolantDegree(memory_, 3), "ERKStepSetInterpolantDegree");
        checked(ERKStepSetErrFile(memory_, nullptr), "ERKStepSetErrFile");
        checked(ERKStepSetMaxErrTestFails(memory_, 100),
                "ERKStepSetMaxErrTestFails");  // jumps of the dashpots
        checked(ERKStepSetMaxNumSteps(memory_, 1'000'000), "ERKStepSetMaxNumSteps");
    }
    RungeKutta(const RungeKutta&) = delete;
    RungeKutta& operator=(const RungeKutta&) = delete;
    ~RungeKutta() { ERKStepFree(&memory_); }

    void find_roots(int count, ARKRootFn values) {
        checked(ERKStepRootInit(memory_, count, values), "ERKStepRootInit");
        checked(ERKStepSetNoInactiveRootWarn(memory_), "ERKStepSetNoInactiveRootWarn");
    }
    void begin(N_Vector y) { checked(ERKStepReInit(memory_, slope_, 0, y), "ERKStepReInit"); }
    /// Keeps the step size.
    void restart(double t, N_Vector y) { checked(ERKStepReset(memory_, t, y), "ERKStepReset"); }
    bool advance(double until, N_Vector y, double& t) {
        return checked(ERKStepEvolve(memory_, until, y, &t, ARK_NORMAL), "ERKStepEvolve") == ARK_ROOT_RETURN;
    }
    void roots(int* found) { checked(ERKStepGetRootInfo(memory_, found), "ERKStepGetRootInfo"); }

private:
    ARKRhsFn slope_;
    void* memory_;
};

}  // namespace

std::vector<Contender> arkode_contenders(const Problem& problem) {
    struct Table {
        const char* name;
        ARKODE_ERKTableID id;
    };
    std::vector<Contender> list;
    for (const Table table : {Table{"ARKODE Dormand-Prince", ARKODE_DORMAND_PRINCE_7_4_5},
                              Table{"ARKODE Verner 6(5)", ARKODE_VERNER_8_5_6}}) {
        for (const double tolerance : tolerances(1e-3)) {
            for (const Contacts contacts : {Contacts::by_overlap, Contacts::located}) {
                list.push_back(
                    sundials_contender<RungeKutta>(problem, table.name, tolerance, contacts, table.id));
            }
        }
    }
    return list;
}

}  // namespace hertzline::bench
