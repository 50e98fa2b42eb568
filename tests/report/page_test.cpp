#include "report/page.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "report/json.hpp"
#include "sample_results.hpp"

using namespace extremal;
using Json = nlohmann::ordered_json;

namespace {

/// Why pages are absent from this build; empty where they are there.
std::string absence() {
  try {
    require_pages();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

class Page : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!absence().empty()) GTEST_SKIP() << absence();
  }
};

std::string between(const std::string& text, const std::string& from, const std::string& to) {
  const std::size_t begin = text.find(from), end = text.find(to, begin + from.size());
  if (begin == text.npos || end == text.npos) return "";
  return text.substr(begin + from.size(), end - begin - from.size());
}

Json data_in(const std::string& page) {
  return Json::parse(between(page, "<script type=\"application/json\" id=\"data\">", "</script>"));
}

Picture picture_of_samples(const Result& result) {
  return {.title = result.title, .names = result.names, .samples = *result.samples};
}

std::string page_of(const Result& result) { return page(result, picture_of_samples(result)); }

/// Bytes of base64, four characters at a time.
std::string decoded(const std::string& text) {
  static const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned word = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    word = word << 6 | static_cast<unsigned>(digits.find(c));
    bits += 6;
    if (bits >= 8) bytes += static_cast<char>(word >> (bits -= 8) & 255);
  }
  return bytes;
}

template <class Number>
std::vector<Number> numbers(const Json& text) {
  const std::string bytes = decoded(text.get<std::string>());
  std::vector<Number> values(bytes.size() / sizeof(Number));
  std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char*>(values.data()));
  return values;
}

TEST_F(Page, HoldsTheResultAsWritten) {
  Result result = transfer_result();
  const Json data = data_in(page_of(result));
  result.samples.reset();
  std::ostringstream written;
  write_json(written, result);
  EXPECT_EQ(data.at("result"), Json::parse(written.str()));
}

TEST_F(Page, ColumnsAreTheSamples) {
  const Result result = transfer_result();
  const Json picture = data_in(page_of(result)).at("picture");
  const Json& solution = picture.at("solutions").at(0);
  EXPECT_EQ(numbers<double>(solution.at("t")), result.samples->t);
  ASSERT_EQ(solution.at("columns").size(), 4u);
  for (std::size_t a = 0; a < 2; ++a) {
    const Json& column = solution["columns"][a];
    const std::vector<float> parts = numbers<float>(column.at("numbers"));
    ASSERT_EQ(parts.size(), 2u);
    for (std::size_t k = 0; k < 2; ++k)
      EXPECT_NEAR(column["centre"].get<double>() + column["reach"].get<double>() * parts[k],
                  result.samples->q[a][k], 1e-7);
  }
  EXPECT_EQ(picture.at("views").at(0).at("kind"), "path");
  EXPECT_EQ(picture["views"][0]["bodies"][0]["columns"], (std::vector<int>{0, 1}));
  EXPECT_EQ(picture.at("panels").size(), 2u);
}

TEST_F(Page, ForcesAreAPanelOfTheirOwn) {
  Result result = transfer_result();
  result.samples->constraint_forces = {{0, 0}};  // none is drawn where there is none
  result.samples->path_forces = {{0.5, 2}};
  const Json picture = data_in(page_of(result)).at("picture");
  ASSERT_EQ(picture.at("solutions").at(0).at("columns").size(), 5u);
  const Json& panel = picture.at("panels").back();
  EXPECT_EQ(panel.at("columns"), (std::vector<int>{4}));
  EXPECT_EQ(panel.at("names"), (std::vector<std::string>{"contact 1"}));
  EXPECT_LT(panel.at("range").at(0).get<double>(), 0.5);
  EXPECT_GT(panel.at("range").at(1).get<double>(), 2);
}

TEST_F(Page, BoundariesOfObstaclesAreThoseOfThePicture) {
  const Result result = transfer_result();
  Picture picture = picture_of_samples(result);
  picture.obstacles.push_back({{0.0, 0.5, 1.0}, {1.0, 1.25, 1.0}});
  const Json view = data_in(page(result, picture)).at("picture").at("views").at(0);
  ASSERT_EQ(view.at("obstacles").size(), 1u);
  EXPECT_EQ(view["obstacles"][0]["x"], picture.obstacles[0].x);
  EXPECT_EQ(view["obstacles"][0]["y"], picture.obstacles[0].y);
}

TEST_F(Page, ManySamplesAreThinned) {
  Result result = transfer_result();
  const std::size_t count = 200'000;
  for (auto* column :
       {&result.samples->t, &result.samples->q[0], &result.samples->q[1], &result.samples->v[0],
        &result.samples->v[1], &result.samples->p[0], &result.samples->p[1]}) {
    column->resize(count);
    for (std::size_t k = 0; k < count; ++k) (*column)[k] = static_cast<double>(k);
  }
  const std::string made = page_of(result);
  EXPECT_LT(made.size(), 1'500'000u);
  const std::vector<double> t = numbers<double>(data_in(made)["picture"]["solutions"][0]["t"]);
  EXPECT_GT(t.size(), 10'000u);
  EXPECT_EQ(t.front(), 0);
  EXPECT_EQ(t.back(), count - 1.0);
}

TEST_F(Page, TitlesAreNoMarkup) {
  Result result = transfer_result();
  result.title = "</script><script>alert(1)</script>&<!--";
  const std::string made = page_of(result);
  EXPECT_EQ(made.find("alert(1)</script>"), made.npos);
  EXPECT_EQ(between(made, "<title>", "</title>"),
            "&lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;&amp;&lt;!--");
  EXPECT_EQ(data_in(made).at("title"), result.title);
}

TEST_F(Page, IsWholeByItself) {
  const std::string made = page_of(transfer_result());
  for (const char* outside : {"src=", "href=", "@import", "url("})
    EXPECT_EQ(between(made, "<body>", "<script>").find(outside), std::string::npos) << outside;
  EXPECT_NE(made.find("three"), made.npos);
  EXPECT_NE(made.find("Permission is hereby granted"), made.npos);  // licences
}

TEST_F(Page, OfASavedResultIsTheSame) {
  const Result result = transfer_result();
  std::ostringstream written;
  write_json(written, result);
  EXPECT_EQ(data_in(saved_page(written.str(), "r.json")), data_in(page_of(result)));
}

std::string refusal(const std::string& text) {
  try {
    saved_page(text, "r.json");
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "not refused";
}

TEST_F(Page, SavedTextsThatAreNoResultsAreRefused) {
  Result result = transfer_result();
  result.samples.reset();
  std::ostringstream written;
  write_json(written, result);
  EXPECT_NE(refusal(written.str()).find("--samples 1000 --output r.json"), std::string::npos);
  EXPECT_NE(refusal("[]").find("this is no result"), std::string::npos);
  EXPECT_NE(refusal("{").find("this is no result"), std::string::npos);
  EXPECT_NE(refusal("{\"status\": 7}").find("no result"), std::string::npos);
  EXPECT_NE(refusal("{\"status\": \"collision\"}").find("'collision'"), std::string::npos);
  EXPECT_NE(refusal("{\"points\": 3}").find("no result"), std::string::npos);
  EXPECT_NE(refusal("{\"points\": [], \"branches\": []}").find("no points"), std::string::npos);
  EXPECT_NE(refusal("{\"rows\": []}").find("no row"), std::string::npos);
  EXPECT_NE(refusal("{\"status\": \"converged\", \"samples\": {\"t\": [0]}}").find("cannot plot"),
            std::string::npos);
  EXPECT_NE(refusal("{\"status\": \"converged\", \"samples\": {\"t\": [0, 1], \"x\": [1], \"x'\": [1, 2]}}")
                .find("x"),
            std::string::npos);
}

TEST(Pages, AreRefusedWhereTheyAreAbsent) {
  if (absence().empty()) {
    EXPECT_NO_THROW(check_plot_path("a.html"));
    return;
  }
  EXPECT_THROW(check_plot_path("a.html"), std::invalid_argument);
  EXPECT_THROW(page_of(transfer_result()), std::invalid_argument);
  EXPECT_THROW(saved_page("{}", "r.json"), std::invalid_argument);
}

}  // namespace
