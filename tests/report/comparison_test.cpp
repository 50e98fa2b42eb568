#include "report/comparison.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "report/layout.hpp"

namespace extremal {
namespace {

Comparison sample() {
  Comparison comparison{.title = "A \"comparison\"",
                        .reference = Comparison::Reference{1e-13, 2e-15, 1.5},
                        .message = "verified",
                        .rows = {}};
  comparison.rows = {{"extremal", 1e-3, 4e-6, 1e-5, Status::converged},
                     {"extremal", 1e-9, 8e-6, 0.0, Status::converged},
                     {"single shooting", 1e-3, 3e-5, 1e-4, Status::converged},
                     {"single shooting", 1e-9, 2e-3, std::nullopt, Status::iteration_limit}};
  return comparison;
}

TEST(Comparison, AsJson) {
  std::ostringstream out;
  write_json(out, sample());
  const auto json = nlohmann::json::parse(out.str());
  EXPECT_EQ(json["reference"]["tolerance"], 1e-13);
  EXPECT_EQ(json["rows"].size(), 4u);
  EXPECT_EQ(json["rows"][0]["error"], 1e-5);
  EXPECT_TRUE(json["rows"][3]["error"].is_null());
  EXPECT_EQ(json["rows"][3]["status"], "iteration-limit");
}

TEST(Comparison, AsText) {
  const std::string text = summary(sample());
  EXPECT_NE(text.find("reference       verified\n"), std::string::npos) << text;
  EXPECT_NE(text.find("single shooting      1e-09           -  2.00 ms  iteration-limit\n"),
            std::string::npos)
      << text;
}

TEST(Comparison, AsFigure) {
  const Figure figure = layout(sample());
  ASSERT_EQ(figure.panels.size(), 1u);
  const Panel& panel = figure.panels[0];
  ASSERT_EQ(panel.curves.size(), 2u);
  EXPECT_EQ(panel.marks.size(), 3u);
  EXPECT_EQ(figure.legend.size(), 2u);
  for (const Curve& curve : panel.curves)
    for (std::size_t k = 0; k < curve.x.size(); ++k) {
      EXPECT_TRUE(panel.x.place(curve.x[k]) >= 0 && panel.x.place(curve.x[k]) <= 1);
      EXPECT_TRUE(panel.y.place(curve.y[k]) >= 0 && panel.y.place(curve.y[k]) <= 1);
    }
  EXPECT_EQ(panel.y.ticks.front().text, "1 µs");
  EXPECT_EQ(panel.x.ticks.front().text, "1e-17");
  EXPECT_EQ(panel.x.ticks.back().text, "1e-3");
  Comparison unknown = sample();
  for (ComparisonRow& row : unknown.rows) row.error.reset();
  EXPECT_THROW(layout(unknown), std::invalid_argument);
}

}  // namespace
}  // namespace extremal
