// The page of `zenith view` in a real browser: live from two daemons that merge, and a replay with
// its slider. Screenshots stay in out/view.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "platform/link/fleet_key.h"
#include "tests/support/figure.h"
#include "tests/support/patience.h"
#include "tests/system/browser.h"
#include "tests/system/sim_daemon.h"
#include "tests/system/view_server.h"

namespace zenith {
namespace {

constexpr double kLimit_s = kPatience_s;  // what is waited for is a state
constexpr const char* kPictures = ZENITH_SOURCE_DIR "/out/view/";

class ViewTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!Browser::is_installed()) {
      GTEST_SKIP() << "SKIPPED, the page was not tested: there is no chromium, or no "
                      "chromium-driver; `./dev test --browser` installs them";
    }
  }

  // A page that loads without an error.
  std::unique_ptr<Browser> open() {
    auto browser = std::make_unique<Browser>(folder_.path());
    if (!browser->good()) return browser;
    browser->show(1400, 900, false, false);
    browser->open(view_.address());
    return browser;
  }

  // Whole lines only: where they cut the text of a canvas is not seen, but a row is wider than it.
  static void expect_no_overflow(Browser& browser) {
    EXPECT_EQ(browser.run("return document.documentElement.scrollWidth - innerWidth <= 0"), true)
        << "the page is wider than the screen";
  }

  static void save_all(Browser& browser, const std::string& name) {
    for (const bool phone : {false, true}) {
      for (const bool dark : {false, true}) {
        browser.show(phone ? 390 : 1400, phone ? 844 : 900, phone, dark);
        browser.run("window.zenith.map.fit()");
        (void)wait_until(1.0, [] { return false; });  // drawn, and glided to its place
        expect_no_overflow(browser);
        const std::string file =
            name + (phone ? "-phone" : "-desk") + (dark ? "-dark" : "-light") + ".png";
        EXPECT_TRUE(browser.save_picture(kPictures + file));
      }
    }
    browser.show(1400, 900, false, false);
  }

  // How many colours a canvas has, counted roughly: an empty one has one.
  static int colours(Browser& browser, const std::string& canvas) {
    return browser
        .run("const c = document.getElementById('" + canvas +
             "'); const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
             "const s = new Set(); for (let i = 0; i < d.length; i += 28)"
             " s.add(d[i] << 16 | d[i+1] << 8 | d[i+2]); return s.size")
        .get<int>();
  }

  tools::TemporaryFolder folder_;
  ViewServer view_{folder_.path()};
};

TEST_F(ViewTest, ShowsRobotsLiveAndHowTheyMerge) {
  ASSERT_TRUE(create_fleet_key(folder_.path() / "fleet.key").ok());
  const std::string radio = "interface = \"lo\"\nown_port = 0\n";
  SimDaemon r1(folder_.path(), "r1", radio);
  SimDaemon r2(folder_.path(), "r2", radio);
  for (SimDaemon* daemon : {&r1, &r2}) ASSERT_TRUE(daemon->start()) << daemon->log();
  ASSERT_TRUE(view_.start(
      {(folder_.path() / "r1.sock").string(), (folder_.path() / "r2.sock").string()}, kLimit_s))
      << view_.log();
  const auto browser = open();
  ASSERT_TRUE(browser->good()) << browser->error();

  ASSERT_TRUE(browser->wait_for("window.zenith?.fleet.robots.length === 2", kLimit_s));
  ASSERT_TRUE(
      browser->wait_for("document.getElementById('connection').textContent === 'live'", kLimit_s));
  ASSERT_TRUE(browser->wait_for("window.zenith.fleet.robots[0].maps.get(-1)?.size > 20", kLimit_s))
      << "landmarks come";
  ASSERT_TRUE(browser->wait_for("window.zenith.fleet.robots[0].path.length > 3", kLimit_s));
  ASSERT_TRUE(
      browser->wait_for("Number(document.getElementById('eye').dataset.drawn) > 0", kLimit_s))
      << "the picture comes";
  EXPECT_GT(colours(*browser, "eye"), 50);
  EXPECT_GT(colours(*browser, "map"), 5);
  EXPECT_EQ(browser->run("return document.querySelectorAll('#robots [role=tab]').length"), 2);

  // The merge becomes visible: the peer's map lies where the alignment says.
  ASSERT_TRUE(browser->wait_for(
      "window.zenith.map.layers.find(l => l.name === 'r2')?.placed === true", kLimit_s));
  ASSERT_TRUE(
      browser->wait_for("document.getElementById('legend').textContent.includes('joined') "
                        "&& document.getElementById('peers').textContent.includes('joined')",
                        kLimit_s));
  ASSERT_TRUE(
      browser->wait_for("document.getElementById('state').textContent === 'merged'", kLimit_s));
  save_all(*browser, "live");

  // The keyboard reaches it.
  browser->run("document.getElementById('map').focus()");
  const double scale = browser->run("return window.zenith.map.scale").get<double>();
  browser->press("++");
  EXPECT_GT(browser->run("return window.zenith.map.scale").get<double>(), 1.5 * scale);
  browser->press("f");
  EXPECT_EQ(browser->run("return window.zenith.map.following"), true);
  browser->press("0");
  EXPECT_EQ(browser->run("return window.zenith.map.fitting"), true);

  // What it saves.
  const auto svg = browser->run("return window.zenith.map.svg()").get<std::string>();
  EXPECT_THAT(svg, testing::StartsWith("<svg xmlns"));
  EXPECT_GT(std::count(svg.begin(), svg.end(), '\n'), 100);
  EXPECT_EQ(browser->run("return new DOMParser().parseFromString(window.zenith.map.svg(), "
                         "'image/svg+xml').querySelector('parsererror') === null"),
            true);
  browser->run("window.zenith.map.png().then(b => window.saved = b.size)");
  EXPECT_TRUE(browser->wait_for("window.saved > 10000", kLimit_s));
  EXPECT_THAT(browser->console(), testing::IsEmpty());

  // The slider looks back, at this page alone; metrics stay with what is now.
  browser->run(
      "const s = document.getElementById('slider'); s.value = 2;"
      " s.dispatchEvent(new Event('input')); s.dispatchEvent(new Event('change'))");
  ASSERT_TRUE(
      browser->wait_for("document.getElementById('connection').textContent === 'past'", kLimit_s));
  ASSERT_TRUE(browser->wait_for("window.zenith.fleet.clock.position_s === 2", kLimit_s));
  EXPECT_TRUE(
      browser->wait_for("!window.zenith.map.layers.find(l => l.name === 'r2')?.placed", kLimit_s))
      << "they had not joined yet";
  EXPECT_EQ(browser->run("return document.getElementById('confidence').hidden"), true)
      << "what came later is not shown";
  EXPECT_EQ(browser->run("return document.querySelectorAll('#marks i').length > 0"), true)
      << "a merge is marked";
  save_all(*browser, "past");
  browser->run("document.getElementById('to-live').click()");
  ASSERT_TRUE(
      browser->wait_for("document.getElementById('connection').textContent === 'live' "
                        "&& document.getElementById('to-live').hidden",
                        kLimit_s));
  EXPECT_TRUE(browser->wait_for(
      "window.zenith.map.layers.find(l => l.name === 'r2')?.placed === true", kLimit_s));

  // Who falls silent is told of; so is the loss of the program itself.
  r1.kill();
  EXPECT_TRUE(
      browser->wait_for("!document.getElementById('map-note').hidden && "
                        "document.getElementById('connection').className === 'lost'",
                        kLimit_s));
  view_.kill();
  EXPECT_TRUE(browser->wait_for(
      "document.getElementById('connection').textContent === 'connection lost'", kLimit_s));
  EXPECT_TRUE(browser->save_picture(std::string(kPictures) + "lost.png"));
}

TEST_F(ViewTest, PlaysAReplayWithItsSlider) {
  std::filesystem::create_directory(folder_.path() / "out");
  tools::write_text(folder_.path() / "out" / "timeline.jsonl", short_timeline());
  ASSERT_TRUE(view_.start({(folder_.path() / "out").string()}, kLimit_s)) << view_.log();
  const auto browser = open();
  ASSERT_TRUE(browser->good()) << browser->error();
  ASSERT_TRUE(browser->wait_for("!document.getElementById('player').hidden", kLimit_s));
  const auto seek = [&](double to_s) {
    browser->run("const s = document.getElementById('slider'); s.value = " + std::to_string(to_s) +
                 "; s.dispatchEvent(new Event('input')); s.dispatchEvent(new Event('change'))");
    return browser->wait_for(
        "Math.abs(window.zenith.fleet.clock.position_s - " + std::to_string(to_s) + ") < 0.06",
        kLimit_s);
  };
  const char* joined = "window.zenith.map.layers.find(l => l.name === 'bert')?.placed === true";
  EXPECT_TRUE(seek(3.5));
  EXPECT_TRUE(browser->wait_for(joined, kLimit_s));
  EXPECT_TRUE(browser->wait_for("document.querySelectorAll('#marks i').length === 1", kLimit_s));
  EXPECT_TRUE(seek(1.0)) << "and back";
  EXPECT_TRUE(browser->wait_for(std::string("!(") + joined + ")", kLimit_s));
  EXPECT_EQ(browser->run("return window.zenith.fleet.robots[0].maps.get(-1).size"), 2);
  EXPECT_EQ(browser->run("return document.getElementById('clock').textContent"), "0:01 / 0:04");
  browser->run("document.getElementById('play').click()");
  EXPECT_TRUE(browser->wait_for("window.zenith.fleet.clock.position_s === 4", kLimit_s));
  EXPECT_TRUE(browser->wait_for(joined, kLimit_s));
  EXPECT_THAT(browser->console(), testing::IsEmpty());
}

}  // namespace
}  // namespace zenith
