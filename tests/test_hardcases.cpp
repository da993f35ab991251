// `talbot hardcases`: that a bad row is seen as bad, and the command from outside.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "app/hardcases/run_cases.h"
#include "app/hardcases/selection.h"
#include "tests/program.h"

namespace talbot::hardcases {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

CaseResult with(const std::vector<Measure>& measures) {
    CaseResult result;
    result.measures = measures;
    return result;
}

Measure at_most(double naive, double own, double limit) {
    return {"errors", naive, own, limit, Gate::at_most, ""};
}
Measure at_least(double naive, double own, double limit) {
    return {"share", naive, own, limit, Gate::at_least, ""};
}

Verdict verdict_of(const std::vector<Measure>& measures) {
    return judge(with(measures)).verdict;
}

TEST(HardCases, PassNeedsAGoodFigureAndAControlThatFails) {
    EXPECT_EQ(verdict_of({at_most(5, 0, 0)}), Verdict::pass);
    EXPECT_EQ(verdict_of({at_most(kInf, 1, 2)}), Verdict::pass);
    EXPECT_EQ(verdict_of({at_least(0.5, 0.95, 0.9)}), Verdict::pass);
    EXPECT_EQ(verdict_of({at_most(kNaN, 1, 2), at_most(3, 1, 2)}), Verdict::pass);
}

TEST(HardCases, OwnFigureBeyondTheLimitFails) {
    EXPECT_EQ(verdict_of({at_most(5, 1, 0)}), Verdict::fail);
    EXPECT_EQ(verdict_of({at_least(0.5, 0.89, 0.9)}), Verdict::fail);
    EXPECT_EQ(verdict_of({at_most(5, kNaN, 2)}), Verdict::fail);
    EXPECT_EQ(verdict_of({at_most(5, kInf, 2)}), Verdict::fail);
    EXPECT_EQ(verdict_of({at_most(5, 0, 0), at_most(kNaN, 3, 2)}), Verdict::fail);
    EXPECT_EQ(verdict_of({}), Verdict::fail);
}

TEST(HardCases, ControlThatPassesMakesARowBlind) {
    EXPECT_EQ(verdict_of({at_most(0, 0, 0)}), Verdict::blind);
    EXPECT_EQ(verdict_of({at_most(kNaN, 0, 0)}), Verdict::blind);
    EXPECT_EQ(verdict_of({at_least(0.95, 0.95, 0.9)}), Verdict::blind);
}

TEST(HardCases, RowShowsTheWorstMeasure) {
    EXPECT_EQ(judge(with({at_most(9, 1, 4), at_most(9, 3, 4), at_most(9, 0, 4)})).worst, 1u);
    EXPECT_EQ(judge(with({at_most(9, 5, 4), at_most(9, 3, 4)})).worst, 0u);
    EXPECT_EQ(judge(with({at_most(9, 3, 4), at_most(9, kNaN, 4)})).worst, 1u);
    EXPECT_EQ(judge(with({at_most(kNaN, 0, 0), at_most(9, 0, 0)})).worst, 1u);
}

TEST(HardCases, MarginIsTheRatioToTheLimit) {
    EXPECT_DOUBLE_EQ(margin(at_most(9, 2, 4)), 2);
    EXPECT_DOUBLE_EQ(margin(at_least(0, 0.9, 0.6)), 1.5);
    EXPECT_EQ(margin(at_most(9, 0, 0)), kInf);
    EXPECT_EQ(margin(at_most(9, 1, 0)), 0);
    EXPECT_EQ(margin(at_most(9, kNaN, 4)), 0);
}

HardCase planted(const std::string& id, Priority priority, CaseResult result) {
    return {id, priority, id, "", "", "", [result](Effort) { return result; }};
}

TEST(HardCases, PlantedBadCasesBreakTheRun) {
    const HardCase good = planted("A1", Priority::p0, with({at_most(5, 0, 0)}));
    const HardCase bad = planted("A2", Priority::p0, with({at_most(5, 1, 0)}));
    const HardCase blind = planted("A3", Priority::p0, with({at_most(0, 0, 0)}));
    const HardCase rare = planted("A4", Priority::p1, with({at_most(5, 1, 0)}));
    HardCase throwing = good;
    throwing.run = [](Effort) -> CaseResult { throw std::runtime_error("no such luck"); };

    EXPECT_TRUE(total(run_cases({good, rare}, Effort::quick, {}).rows).kept);
    for (const HardCase& broken : {bad, blind, throwing}) {
        const RunOutcome outcome = run_cases({good, broken, good}, Effort::quick, {});
        ASSERT_EQ(outcome.rows.size(), 3u);
        EXPECT_FALSE(total(outcome.rows).kept);
        EXPECT_EQ(total(outcome.rows).passed, 2u);
    }
    const RunOutcome thrown = run_cases({throwing}, Effort::quick, {});
    EXPECT_EQ(thrown.rows[0].judgement.verdict, Verdict::fail);
    EXPECT_NE(thrown.rows[0].judgement.why.find("no such luck"), std::string::npos);
}

TEST(HardCases, TotalsAddUpWhatWasCounted) {
    CaseResult result = with({at_most(9, 2, 4)});
    result.nonfinite = 3;
    result.clamped = 4;
    const RunOutcome outcome =
        run_cases({planted("A1", Priority::p0, result), planted("A2", Priority::p0, result)},
                  Effort::quick, {});
    const Totals totals = total(outcome.rows);
    EXPECT_EQ(totals.nonfinite, 6u);
    EXPECT_EQ(totals.clamped, 8u);
    ASSERT_NE(totals.worst, nullptr);
    EXPECT_DOUBLE_EQ(margin(*totals.worst->shown()), 2);
}

TEST(HardCases, RowsAreChosenByIdAndUnknownOnesNamed) {
    const std::vector<HardCase> cases{planted("E05", Priority::p0, {}),
                                      planted("G01", Priority::p0, {})};
    const Result<Selection> chosen = select_rows({"g01", "V06"}, cases, {{"V06", "", ""}});
    ASSERT_TRUE(chosen);
    ASSERT_EQ(chosen->cases.size(), 1u);
    EXPECT_EQ(chosen->cases[0].id, "G01");
    EXPECT_EQ(chosen->not_simulated.size(), 1u);
    const Result<Selection> unknown = select_rows({"E55"}, cases, {});
    ASSERT_FALSE(unknown);
    EXPECT_EQ(unknown.error().kind, ErrorKind::usage);
    EXPECT_NE(unknown.error().what.find("E05"), std::string::npos);
}

TEST(HardCasesCommand, OneRowAsTableAndJson) {
    const program::Folder folder("hardcases");
    const std::string json = folder / "rows.json";
    const std::string html = folder / "rows.html";
    const program::Outcome run =
        program::run("hardcases --only e05 --json " + json + " --html " + html);
    EXPECT_EQ(run.code, 0) << run.output;
    EXPECT_NE(run.output.find("E05"), std::string::npos);
    EXPECT_NE(run.output.find("contraction off"), std::string::npos) << run.output;
    const nlohmann::json j = program::read_json(json);
    EXPECT_EQ(j["schema"], "talbot-hardcases/1");
    ASSERT_EQ(j["cases"].size(), 1u);
    EXPECT_EQ(j["cases"][0]["verdict"], "PASS");
    EXPECT_TRUE(j["kept"]);
    EXPECT_EQ(j["machine"]["worker"]["contracts"], false);
    const std::string page = program::read_text(html);
    EXPECT_NE(page.find("E05"), std::string::npos);
    EXPECT_EQ(page.find("http"), std::string::npos) << "the page must not need a network";
}

TEST(HardCasesCommand, BadOptionsAreOneClearLine) {
    const program::Outcome unknown = program::run("hardcases --only G99");
    EXPECT_EQ(unknown.code, 2);
    EXPECT_NE(unknown.output.find("near it: "), std::string::npos) << unknown.output;
    EXPECT_EQ(program::run("hardcases --quick --full").code, 2);
    EXPECT_EQ(program::run("hardcases --nonsense").code, 2);
    EXPECT_EQ(program::run("hardcases --only E05 --json /no/such/folder/x.json").code, 4);
    EXPECT_EQ(program::run("hardcases --only E05 --json a.out --html a.out").code, 2);
}

TEST(HardCasesCommand, InterruptWritesWhatRan) {
    const program::Folder folder("hardcases-interrupt");
    const std::string json = folder / "rows.json";
    // The whole interval of E05 takes much longer than the second after which it is stopped.
    const program::Outcome run = program::run("hardcases --full --only E05 --json " + json +
                                              " & pid=$!; sleep 1; kill -TERM $pid; wait $pid");
    EXPECT_EQ(run.code, 130) << run.output;
    const nlohmann::json j = program::read_json(json);
    EXPECT_EQ(j["interrupted"], true);
}

TEST(HardCasesCommand, StressKeepsThePromisesOfABuiltInScene) {
    const program::Folder folder("hardcases-stress");
    const std::string json = folder / "stress.json";
    const program::Outcome run =
        program::run("hardcases --scene " TALBOT_SOURCE_DIR
                     "/assets/scenes/spheres.gltf --size 32x32 --frames 2 --json " +
                         json,
                     "", "", 240);
    EXPECT_EQ(run.code, 0) << run.output;
    const nlohmann::json j = program::read_json(json);
    EXPECT_EQ(j["schema"], "talbot-stress/1");
    EXPECT_TRUE(j["kept"]);
    int moved = 0;
    for (const nlohmann::json& row : j["transforms"]) {
        const std::string name = row["transform"];
        if (name.find("2^") != std::string::npos) {
            EXPECT_EQ(row["same_bytes"], true) << name;
        }
        moved += name.find("moved") != std::string::npos ? 1 : 0;
    }
    EXPECT_EQ(moved, 6);
    EXPECT_EQ(program::run("hardcases --scene /no/such.gltf").code, 3);
    EXPECT_EQ(program::run("hardcases --scene x.gltf --only G01").code, 2);
    EXPECT_EQ(program::run("hardcases --size 5x5").code, 2);
}

}  // namespace
}  // namespace talbot::hardcases
