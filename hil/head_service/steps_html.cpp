// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "hil/head_service/service_steps.h"
#include "hil/report/html_text.h"

namespace kerfbench::head_service {
namespace {

using State = ServiceStep::State;

constexpr std::string_view kStepsCss = R"css(
.service{list-style:none;padding:0;margin:0}
.service>li{display:grid;grid-template-columns:26px minmax(0,1fr) max-content;gap:2px 12px;align-items:start;background:var(--card);border-left:5px solid var(--line);border-radius:6px;padding:8px 14px;margin:8px 0;break-inside:avoid}
.service>li.now{border-left-color:var(--acc)}.service>li.done{border-left-color:var(--pass)}.service>li.wrong{border-left-color:var(--fail)}
.service input{width:18px;height:18px;margin:3px 0 0}.service h3{margin:0;font-size:16px}.service label{cursor:pointer}
.service .state{font-size:13px;font-weight:650;color:var(--mute)}.service .now .state{color:var(--acc)}.service .wrong .state{color:var(--fail)}.service .done .state{color:var(--pass)}
.service .body{grid-column:2/-1}.service p{margin:3px 0}.service ul{margin:3px 0;padding-left:20px}.service .is{color:var(--fail);font-weight:600}
.service .later h3{color:var(--mute)}
@media print{.service input{appearance:none;border:1.5px solid #000;border-radius:2px}.service input:checked{background:#000}}
)css";

std::string lines(const std::vector<std::string>& texts, std::string_view css_class) {
  std::string html;
  for (const std::string& text : texts)
    html += fmt::format("<p{}>{}</p>", css_class, report::escapeHtml(text));
  return html;
}

std::string filesOf(const ServiceStep& step) {
  std::string html;
  for (const ServiceStep::File& file : step.files) {
    const std::string path = report::escapeHtml(file.path);
    html += fmt::format("<li><a href='{0}'>{0}</a>: {1}", path, report::escapeHtml(file.what));
  }
  return html.empty() ? html : "<ul>" + html + "</ul>";
}

std::string itemOf(const ServiceStep& step, std::size_t number) {
  const bool wrong = !step.wrong.empty();
  const std::string id = report::escapeHtml(step.id);
  // What is done needs no telling how, but what came of it.
  const bool told = step.state != State::kDone;
  return fmt::format(
      "<li class='{}{}' id='{}'><input type=checkbox id='tick-{}'{}><h3><label for='tick-{}'>{}. "
      "{}</label></h3>"
      "<span class=state>{}</span><div class=body>{}{}{}{}</div></li>\n",
      nameOf(step.state), wrong ? " wrong" : "", id, id, step.state == State::kDone ? " checked" : "", id,
      number, report::escapeHtml(step.title), wrong ? "to be mended" : nameOf(step.state),
      told ? lines(step.text, "") : std::string(), lines(step.wrong, " class=is"), lines(step.found, ""),
      filesOf(step));
}

std::string_view classOf(const std::string& verdict) {
  if (verdict.empty() || verdict == "NOT PROVEN") return "notproven";
  return verdict == "GOOD" || verdict == "HOLDS" ? "pass" : "fail";
}

}  // namespace

std::string ServiceSteps::html() const {
  const std::vector<ServiceStep> steps = all();
  const auto done = std::ranges::count(steps, State::kDone, &ServiceStep::state);
  const std::string big =
      verdict_.empty()
          ? fmt::format("Step {} of {}",
                        std::min<std::size_t>(static_cast<std::size_t>(done) + 1, steps.size()), steps.size())
          : verdict_;
  std::string page =
      report::htmlPageHead(fmt::format("{} – {} of {}", big, facts_.kind, facts_.machine), kStepsCss);
  page += fmt::format("<header class={}><div class=big>{}</div><p>{}</p><div class=facts>{}</div></header>\n",
                      classOf(verdict_), report::escapeHtml(big), report::escapeHtml(headline()),
                      report::htmlFacts({{"Machine", facts_.machine},
                                         {"Kerf camera", facts_.camera},
                                         {"Date", facts_.date},
                                         {"Kerfbench", facts_.version}}));
  std::string list = "<ol class=service>\n";
  for (std::size_t k = 0; k < steps.size(); ++k) list += itemOf(steps[k], k + 1);
  page += report::htmlSection("What is to be done", list + "</ol>");
  page += report::htmlSection(
      "To sign",
      "<div class=sign><div>Date</div><div>Name</div><div>Signature</div></div>"
      "<p class=note>Ticks on this page are for you; they are not kept. What the bench knows is ticked when "
      "the page is written, each time the command runs.</p>");
  page += report::htmlSection("Run again", "<pre>" + report::escapeHtml(facts_.command) + "</pre>");
  return page.append(report::kHtmlPageEnd);
}

}  // namespace kerfbench::head_service
