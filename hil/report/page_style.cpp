// SPDX-License-Identifier: Apache-2.0
// What all pages look like, how they begin and end, and what a page may do.
#include <fmt/format.h>

#include "hil/base/digest.h"
#include "hil/report/html_text.h"

namespace kerfbench::report {

const std::string_view kReportCss = R"css(
:root{--bg:#fff;--fg:#1c2430;--mute:#5d6878;--line:#d9dee6;--card:#f6f8fa;--pass:#137a3e;--fail:#b3122b;--np:#9a5b00;
--inv:#5b3fa0;--nom:#7d8896;--b0:#1a7f5a;--b1:#5f8a18;--b2:#a87d00;--b3:#d0620a;--b4:#c4001a;--acc:#1f5fbf}
@media(prefers-color-scheme:dark){:root{--bg:#12161c;--fg:#e4e9f0;--mute:#97a3b4;--line:#2d3643;--card:#1a2029;
--pass:#35b56c;--fail:#f0566c;--np:#e0a13a;--inv:#a58bf0;--nom:#657387;--b0:#35b58a;--b1:#a1c83f;--b2:#e8bd2f;--b3:#f59240;
--b4:#ff5a6e;--acc:#6aa5ff}}
*{box-sizing:border-box}
body{margin:0;background:var(--bg);color:var(--fg);font:15px/1.45 system-ui,"Segoe UI","DejaVu Sans",sans-serif}
main{max-width:1120px;margin:0 auto;padding:24px 28px 48px}
header{display:grid;grid-template-columns:auto minmax(0,1fr);gap:6px 24px;align-items:center;border-left:10px solid;padding:14px 20px;
background:var(--card);border-radius:6px}
header .big{font-size:42px;font-weight:750;letter-spacing:.01em;line-height:1.1;white-space:nowrap}
header p,header h1{margin:0;font-size:18px;line-height:1.35;color:var(--fg)} header .facts{grid-column:1/-1;color:var(--mute);font-size:14px}
.pass{color:var(--pass)}.fail{color:var(--fail)}.notproven{color:var(--np)}.invalid{color:var(--inv)}
header.pass,header.fail,header.notproven,header.invalid{border-color:currentColor}
header p,header .facts{color:var(--fg)}header .facts{color:var(--mute)}
html{scroll-behavior:smooth}@media(prefers-reduced-motion:reduce){html{scroll-behavior:auto}}
:focus-visible{outline:3px solid var(--acc);outline-offset:2px}
.skip{position:absolute;left:-9999px}.skip:focus{left:8px;top:8px;background:var(--bg);padding:6px 10px;z-index:9}
h3{font-size:16px;margin:18px 0 6px}
h2{font-size:20px;margin:34px 0 10px;border-bottom:1px solid var(--line);padding-bottom:4px}
table{border-collapse:collapse;width:100%;font-size:14px;margin:8px 0}
th,td{text-align:left;padding:6px 9px;border-bottom:1px solid var(--line);vertical-align:top}
th{color:var(--mute);font-weight:600;font-size:13px}
.num{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}
.hit{color:var(--fail);font-weight:650} small{color:var(--mute)}
table.checks td:first-child{width:44%}.checks .num,.checks td.v{font-size:13px}table.checks td,table.checks th{padding:7px 6px}
td.v{font-weight:700;white-space:nowrap}td.mute{color:var(--mute);font-weight:400} .why{font-weight:400;color:var(--mute);font-size:13px;display:block;margin-top:2px}
.note{color:var(--mute);font-size:13px;margin:6px 0 0}
ul.problems{border-left:5px solid var(--inv);background:var(--card);padding:10px 10px 10px 30px;margin:12px 0}
ul.lost{border-left-color:var(--np)}
figure{margin:0} .shown{max-width:100%;height:auto} figcaption{font-size:13px;color:var(--mute);margin-top:3px}
.panels{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(330px,100%),1fr));gap:16px}
.plots{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(310px,100%),1fr));gap:14px;margin:10px 0}
.patches{display:grid;grid-template-columns:repeat(auto-fill,minmax(165px,1fr));gap:14px}
svg{display:block;width:100%}svg.die{max-height:640px;background:var(--card);border-radius:6px}
svg.patch{border-radius:4px;background:#000;aspect-ratio:1}
svg.gauge{width:126px;height:16px}
.nominal,.b0,.b1,.b2,.b3,.b4,.missing,.place,.stray{fill:none;vector-effect:non-scaling-stroke}
.nominal{stroke:var(--nom);stroke-width:1}
.b0,.b1,.b2,.b3,.b4{stroke-width:1.8;stroke-linecap:round;stroke-linejoin:round}
.b0{stroke:var(--b0)}.b1{stroke:var(--b1)}.b2{stroke:var(--b2)}.b3{stroke:var(--b3)}.b4{stroke:var(--b4);stroke-width:2.6}
.missing{stroke:#c030c0;stroke-width:4;stroke-linecap:round;stroke-dasharray:2 6}
.place{stroke:var(--fg);stroke-width:1.4}.placeno{fill:var(--fg);font-weight:700}.stray{stroke:var(--b4);stroke-width:2.5}
.px{image-rendering:pixelated;image-rendering:crisp-edges;image-rendering:pixelated}
.pn,.pt{fill:none;vector-effect:non-scaling-stroke;stroke:#20a8ff;stroke-width:1.6}
.pt{stroke:#ff5a3c;stroke-dasharray:4 3;stroke-width:1.3}
.legend{display:flex;flex-wrap:wrap;gap:4px 18px;font-size:13px;margin:6px 0 10px}
.key{display:inline-flex;align-items:center;gap:6px}.key i{width:22px;height:0;border-top:4px solid}
.k0{color:var(--b0)}.k1{color:var(--b1)}.k2{color:var(--b2)}.k3{color:var(--b3)}.k4{color:var(--b4)}.kn{color:var(--nom)}
.km{color:#c030c0;border-top-style:dotted!important}.key i.ks{width:12px;height:12px;border:2.5px solid var(--b4);border-radius:50%}
.frame{fill:var(--card);stroke:var(--line)}.zero{stroke:var(--mute);stroke-width:.6}
.lim{stroke:var(--fail);stroke-width:1.2}.plot .lim{stroke-dasharray:4 3}
.fit{stroke:var(--fg);stroke-width:1.6}.dots{stroke:var(--acc);stroke-width:3;stroke-linecap:round;fill:none}
.sheetdots{stroke:var(--b3);stroke-width:5}.sheetword{color:var(--b3);font-weight:650}.spotword{color:var(--acc);font-weight:650}
.tick{fill:var(--mute);font-size:10px}.bar{fill:var(--acc)}.barbad{fill:var(--fail)}
.gauge .ok{fill:var(--pass);opacity:.35}.gauge .band{fill:var(--np);opacity:.45}.gauge .bad{fill:var(--fail);opacity:.35}
.grid{stroke:var(--line);stroke-width:.6}
.figs{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(440px,100%),1fr));gap:18px 22px;margin:12px 0}
.gauge .unc{stroke:var(--fg);stroke-width:2}.gauge .val{fill:var(--fg)}
pre{background:var(--card);border-radius:6px;padding:10px 14px;overflow:auto;font-size:13px;white-space:pre-wrap}
code{font-size:13px;overflow-wrap:anywhere} a{color:var(--acc)} summary{cursor:pointer;color:var(--acc);margin:6px 0}
nav.contents{margin:14px 0;font-size:14px}nav.contents ul{list-style:none;display:flex;flex-wrap:wrap;gap:4px 16px;margin:0;padding:0}
dl.answer{grid-column:1/-1;display:grid;grid-template-columns:max-content minmax(0,1fr);gap:3px 14px;margin:8px 0 2px;color:var(--fg)}
dl.answer dt{color:var(--mute);font-weight:600}dl.answer dd{margin:0}
tbody th{color:var(--fg)}table.checks tbody th{font-weight:400}h4{margin:14px 0 2px;font-size:14px}
article{color:var(--fg);border-left:5px solid var(--fail);background:var(--card);border-radius:6px;padding:4px 16px 12px;margin:14px 0}
article.fail,article.notproven,article.invalid{color:var(--fg)}article.notproven{border-color:var(--np)}article.invalid{border-color:var(--inv)}article h3{margin:8px 0 2px;color:var(--fg)}
article dl{display:flex;flex-wrap:wrap;gap:4px 26px;margin:6px 0}article dl div{min-width:0}article dt{color:var(--mute);font-size:13px}article dd{margin:0;font-weight:600}
article .frame{fill:var(--bg)}
.seen{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(230px,100%),1fr));gap:14px;max-width:720px;align-items:start}.seen svg.die{max-height:230px;background:var(--bg)}
.along{margin:10px 0 0}.along ul{margin:4px 0;padding-left:20px}.along li{margin:4px 0}
ol.steps{background:var(--card);border-left:5px solid var(--acc);border-radius:6px;padding:10px 14px 10px 34px;margin:10px 0}ol.steps li{margin:4px 0}
.fold{margin:10px 8px 6px 0}.fold+label{cursor:pointer;color:var(--acc)}
@media screen{.fold:not(:checked)~.folded:not(:has(:target)){display:none}}
.scroll{overflow-x:auto}.scroll table{min-width:620px}.scroll svg.wave,.scroll svg.motion{min-width:700px}
:target{outline:3px solid var(--acc);outline-offset:3px}
svg a{cursor:pointer}svg a:focus-visible,svg a:hover{outline:none}svg a:focus-visible path,svg a:hover path{stroke-width:4}
svg.mosaic{max-height:720px;background:#000;border-radius:6px}svg.mosaic .nominal,.overlay path{stroke:#20a8ff;stroke-width:1}.overlay{color:#20a8ff;--nom:#20a8ff}
#show-dieline:not(:checked)~figure .overlay{display:none}
.scale{margin-right:6px}.scale+label{margin-right:18px}.atscale{display:none}
#scale-true:checked~.panels .atscale{display:inline}#scale-true:checked~.panels .enlarged{display:none}
#scale-true:checked~.note .forenlarged{display:none}
.wave text,.motion text{font-size:11px;fill:var(--fg)}.wave .tick,.motion .tick{fill:var(--mute)}
.wire{fill:none;stroke:var(--acc);stroke-width:1.1}.wire.gate{stroke:var(--b3)}.wire.pwm{stroke:var(--b1)}.wire.sensor{stroke:var(--mute)}
.now{stroke:var(--fail);stroke-width:1.4}.nowband{fill:var(--fail);opacity:.16}.job{fill:var(--card);stroke:var(--mute);stroke-width:.7}article .job{fill:var(--bg)}
.speed{fill:none;stroke:var(--b0);stroke-width:1.2}.devdots{stroke:var(--inv);stroke-width:3;stroke-linecap:round;fill:none}
.devword{color:var(--inv);font-weight:650}.speedword{color:var(--b0);font-weight:650}
.spot{fill:none;stroke:var(--fail);stroke-width:3;vector-effect:non-scaling-stroke}
.mayspan{fill:var(--pass);opacity:.25}.cause{fill:var(--np)}.happened{fill:var(--acc)}.toolate{fill:var(--fail)}
th button{font:inherit;color:inherit;background:none;border:0;padding:0;cursor:pointer;text-align:inherit}th[aria-sort=ascending] button::after{content:' ▲'}th[aria-sort=descending] button::after{content:' ▼'}
input.filter{font:inherit;padding:4px 8px;margin:4px 0;border:1px solid var(--mute);border-radius:4px;background:var(--bg);color:var(--fg);max-width:100%}
.record table th{width:30%}.sign{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(240px,100%),1fr));gap:34px 24px;margin:44px 0 10px}.sign div{border-top:1px solid var(--fg);padding-top:4px;font-size:13px}
@media(max-width:700px){header{grid-template-columns:minmax(0,1fr)}header .big{font-size:32px}main{padding:12px}dl.answer{grid-template-columns:minmax(0,1fr)}dl.answer dd{margin-bottom:4px}
table.checks td:first-child{width:auto}td,th,dd,p,li{overflow-wrap:anywhere}}
@media print{:root{--bg:#fff;--fg:#000;--mute:#444;--line:#bbb;--card:#fff;--pass:#137a3e;--fail:#b3122b;--np:#9a5b00;
--inv:#5b3fa0;--nom:#888;--acc:#1f5fbf}
main{max-width:none;padding:0}*{print-color-adjust:exact;-webkit-print-color-adjust:exact}
figure,tr,header{break-inside:avoid}h2,h3{break-after:avoid}summary,nav.contents,.fold,.fold+label,.filter,.scale,.scale+label,.skip{display:none}.scroll{overflow:visible}
.scroll table,.scroll svg.wave,.scroll svg.motion{min-width:0}.record{break-before:page}article{border:1px solid #bbb}body{font-size:12px}}
)css";

const std::string_view kHtmlPageEnd = "</main></body></html>\n";

std::string htmlPageHead(std::string_view title, std::string_view more_css, std::string_view more_head) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=en><head><meta charset=utf-8><meta name=viewport "
      "content='width=device-width'>"
      "<meta name=color-scheme content='light "
      "dark'>{}<title>{}</title><style>{}{}</style></head><body><main>\n",
      more_head, escapeHtml(title), kReportCss, more_css);
}

const std::string_view kReportScript = R"js((function(){
document.querySelectorAll('table.sortable').forEach(function(table){
var body=table.tBodies[0],box=document.createElement('input');
box.type='search';box.className='filter';box.placeholder='Filter these rows';
box.setAttribute('aria-label','Filter the rows of this table');
table.parentNode.parentNode.insertBefore(box,table.parentNode);
box.oninput=function(){var word=box.value.toLowerCase();
Array.prototype.forEach.call(body.rows,function(row){row.hidden=word!==''&&row.textContent.toLowerCase().indexOf(word)<0})};
Array.prototype.forEach.call(table.tHead.rows[0].cells,function(head,column){
var button=document.createElement('button');button.type='button';button.textContent=head.textContent;
head.textContent='';head.appendChild(button);
button.onclick=function(){var up=head.getAttribute('aria-sort')!=='ascending';
Array.prototype.forEach.call(head.parentNode.cells,function(other){other.removeAttribute('aria-sort')});
head.setAttribute('aria-sort',up?'ascending':'descending');
var key=function(row){var text=row.cells[column].textContent,number=parseFloat(text.replace('\u2212','-'));
return isNaN(number)?text:number};
Array.prototype.slice.call(body.rows).map(function(row){return [key(row),row]}).sort(function(a,b){
var x=a[0],y=b[0],numbers=(typeof x==='number')+(typeof y==='number');
var order=numbers===2?x-y:numbers===1?(typeof x==='number'?-1:1):x.localeCompare(y,'en',{numeric:true});
return up?order:-order}).forEach(function(pair){body.appendChild(pair[1])})}})})})();)js";

std::string pageRules() {
  const std::string digits = base::sha256(kReportScript);
  std::string sum;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2)
    sum += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
  return fmt::format(
      "<meta http-equiv=Content-Security-Policy content=\"default-src 'none';img-src data:;style-src "
      "'unsafe-inline';script-src 'sha256-{}';base-uri 'none';form-action 'none'\">",
      base64(sum));
}

std::string htmlFold(std::string_view id, std::string_view label, const std::string& body) {
  if (body.empty()) return {};
  return fmt::format(
      "<div><input type=checkbox class=fold id='fold-{0}'><label for='fold-{0}'>{1}</label><div "
      "class=folded>{2}</div></div>",
      id, escapeHtml(label), body);
}

std::string scrolled(std::string_view label, const std::string& body) {
  return fmt::format("<div class=scroll tabindex=0 role=region aria-label='{}'>{}</div>", escapeHtml(label),
                     body);
}

std::string sectionId(std::string_view title) {
  std::string id;
  for (const char c : title) {
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) id += c;
    if (c >= 'A' && c <= 'Z') id += static_cast<char>(c - 'A' + 'a');
    if (c == ' ' && !id.empty() && id.back() != '-') id += '-';
  }
  return id;
}

std::string htmlSection(std::string_view title, const std::string& body) {
  return body.empty() ? std::string()
                      : fmt::format("<section id='{}'><h2>{}</h2>{}</section>\n", sectionId(title),
                                    escapeHtml(title), body);
}

}  // namespace kerfbench::report
