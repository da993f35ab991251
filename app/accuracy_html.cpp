// The report as one HTML file: table, curves as SVG with values under the pointer, pictures with a
// wipe, error map. No network, no library; the figures are the JSON of --json, embedded.
#include <cstdio>

#include "app/accuracy_report.h"
#include "app/html_text.h"
#include "core/accuracy/metrics.h"

namespace talbot {
namespace {

const char* const kStyle = R"(
body{font:15px/1.45 system-ui,sans-serif;margin:2em auto;max-width:1160px;padding:0 1em;color:#222}
h1{font-size:1.5em}h2{font-size:1.15em;margin-top:2em}
table{border-collapse:collapse}td,th{padding:.25em .8em;text-align:right;border-bottom:1px solid #ddd;
white-space:nowrap}
td:first-child,th:first-child,td.text{text-align:left}
.swatch{display:inline-block;width:.8em;height:.8em;border-radius:.2em;margin-right:.5em}
.light{display:inline-block;width:.7em;height:.7em;border-radius:50%}
.green{background:#2a9d3a}.amber{background:#e6a100}.red{background:#cc2222}.unknown{background:#999}
pre{background:#f3f3f3;padding:.8em;overflow-x:auto}
#tip{position:fixed;display:none;background:#222;color:#fff;padding:.3em .6em;border-radius:.3em;
font-size:.85em;pointer-events:none;white-space:pre}
.wipe{position:relative;display:inline-block;line-height:0}.wipe img{image-rendering:pixelated}
.wipe .over{position:absolute;left:0;top:0;overflow:hidden;border-right:2px solid #fff}
svg text{font-size:12px;fill:#333}
)";

const char* const kScript = R"(
const report=JSON.parse(document.getElementById('data').textContent);
const pictures=JSON.parse(document.getElementById('pictures').textContent);
const ns='http://www.w3.org/2000/svg',colors=pictures.colors;
const make=(tag,attributes,parent)=>{const e=document.createElementNS(ns,tag);
 for(const k in attributes)e.setAttribute(k,attributes[k]);parent.appendChild(e);return e;};
const figure=(x)=>x===null||x===undefined?'-':Number(x).toPrecision(3);
const table=document.querySelector('#table tbody');
report.results.forEach((r,i)=>{const row=table.insertRow(),t=r.to_target,last=r.curve[r.curve.length-1];
 const cell=(text,cls)=>{const c=row.insertCell();c.textContent=text;if(cls)c.className=cls;return c;};
 const name=cell('');const s=document.createElement('span');s.className='swatch';
 s.style.background=colors[i];name.append(s,r.configuration);
 cell(t.seconds===null?t.why:figure(t.seconds)+' s ('+figure(t.lo95)+' to '+figure(t.hi95)+')'+
  (t.measured?'':', predicted'),t.seconds===null?'text':'');
 cell(last?figure(last.relrmse_percent)+' %':'-');cell(last?figure(last.seconds)+' s':'-');
 cell(last?figure(last.exponent):'-');
 cell(r.bias===null?'none':r.bias.significant?figure(r.bias.floor_percent)+' %':
  r.bias.hi95>0?'below '+figure(r.bias.hi95)+' %':'no difference');
 const l=cell('','text');const dot=document.createElement('span');dot.className='light '+r.trust;
 dot.title=r.why;l.append(dot);cell(r.pareto?'yes':'');});
const svg=document.getElementById('curves'),W=1000,H=520,L=60,R=20,T=15,B=45;
let xs=[],ys=[report.target_percent];
report.results.forEach(r=>r.curve.forEach(p=>{if(p.lo95>0&&p.seconds>0){xs.push(p.seconds);
 ys.push(p.lo95,p.hi95);}}));
if(xs.length>1){
const lx=[Math.min(...xs),Math.max(...xs)].map(Math.log10),ly=[Math.min(...ys),Math.max(...ys)].map(Math.log10);
const X=v=>L+(Math.log10(v)-lx[0])/((lx[1]-lx[0])||1)*(W-L-R);
const Y=v=>H-B-(Math.log10(v)-ly[0])/((ly[1]-ly[0])||1)*(H-T-B);
const ticks=(a,f)=>{for(let d=Math.floor(a[0]);d<=a[1];++d)for(const m of[1,2,5]){const v=m*Math.pow(10,d),
 g=Math.log10(v);if(g>=a[0]&&g<=a[1])f(v);}};
ticks(lx,v=>{make('line',{x1:X(v),x2:X(v),y1:T,y2:H-B,stroke:'#ddd'},svg);
 make('text',{x:X(v),y:H-B+16,'text-anchor':'middle'},svg).textContent=figure(v);});
ticks(ly,v=>{make('line',{x1:L,x2:W-R,y1:Y(v),y2:Y(v),stroke:'#ddd'},svg);
 make('text',{x:L-6,y:Y(v)+4,'text-anchor':'end'},svg).textContent=figure(v)+' %';});
make('text',{x:W-R,y:H-6,'text-anchor':'end'},svg).textContent='seconds of rendering';
make('line',{x1:L,x2:W-R,y1:Y(report.target_percent),y2:Y(report.target_percent),stroke:'#c00',
 'stroke-dasharray':'6 4'},svg);
const tip=document.getElementById('tip');
report.results.forEach((r,i)=>{const c=r.curve.filter(p=>p.lo95>0&&p.seconds>0),g=make('g',{},svg);
 const up=c.map(p=>X(p.seconds)+','+Y(p.hi95)),down=c.map(p=>X(p.seconds)+','+Y(p.lo95)).reverse();
 make('polygon',{points:up.concat(down).join(' '),fill:colors[i],opacity:.13},g);
 make('polyline',{points:c.map(p=>X(p.seconds)+','+Y(p.relrmse_percent)).join(' '),fill:'none',
  stroke:colors[i],'stroke-width':2},g);
 c.forEach(p=>{const dot=make('circle',{cx:X(p.seconds),cy:Y(p.relrmse_percent),r:4,fill:colors[i],
   'class':'point'},g);
  dot.addEventListener('mouseenter',e=>{tip.textContent=r.configuration+'\n'+p.samples+' samples, '+
   figure(p.seconds)+' s\nerror '+figure(p.relrmse_percent)+' % ('+figure(p.lo95)+' to '+figure(p.hi95)+
   ')';tip.style.display='block';
   tip.style.left=Math.min(e.clientX+12,document.documentElement.clientWidth-tip.offsetWidth-8)+'px';
   tip.style.top=Math.min(e.clientY+12,innerHeight-tip.offsetHeight-8)+'px';});
  dot.addEventListener('mouseleave',()=>{tip.style.display='none';});});});}
if(report.why){const body=document.querySelector('#why tbody');document.getElementById('why').hidden=false;
 [report.why.kinds,report.why.lights].forEach(list=>list.forEach(s=>{const row=body.insertRow();
  [s.label,(100*s.error_share).toFixed(1)+' %',(100*s.light_share).toFixed(1)+' %',
   s.help?s.help+': '+figure(s.help_factor)+'x':''].forEach(t=>{row.insertCell().textContent=t;});}));}
const left=document.getElementById('left'),right=document.getElementById('right');
const chooser=(select,pick)=>{pictures.images.forEach((p,i)=>select.add(new Option(p.name,i)));
 select.selectedIndex=pick;};
const a=document.getElementById('a'),b=document.getElementById('b');
chooser(a,0);chooser(b,Math.min(1,pictures.images.length-1));
const over=document.querySelector('.over'),range=document.getElementById('range');
const show=()=>{left.src=pictures.images[a.value].url;right.src=pictures.images[b.value].url;wipe();};
const wipe=()=>{const w=document.querySelector('.wipe').clientWidth;over.style.width=w*range.value/100+'px';};
[a,b].forEach(s=>s.addEventListener('change',show));range.addEventListener('input',wipe);
right.addEventListener('load',()=>{const w=Math.max(480,right.naturalWidth)+'px';
 left.style.width=w;right.style.width=w;wipe();});show();
document.getElementById('copy').addEventListener('click',()=>{
 const text=document.getElementById('command').textContent;
 if(navigator.clipboard)navigator.clipboard.writeText(text);});
)";

// Inside a script element nothing may look like its end.
std::string embed(std::string json) {
    for (std::size_t at = 0; (at = json.find('<', at)) != std::string::npos; at += 6)
        json.replace(at, 1, "\\u003c");
    return json;
}

std::string json_string(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
    return out + '"';
}

// Blocks as pixels of the image's size.
ImageBytes block_map(const SweepResult& r) {
    constexpr uint32_t kBlock = 8;
    const std::size_t columns = (r.width + kBlock - 1) / kBlock;
    std::vector<float> errors(std::size_t{r.width} * r.height, 0.0f);
    for (uint32_t y = 0; y < r.height; ++y) {
        for (uint32_t x = 0; x < r.width; ++x) {
            const std::size_t block = y / kBlock * columns + x / kBlock;
            if (block < r.block_errors.size())
                errors[std::size_t{y} * r.width + x] = 0.01f * r.block_errors[block];
        }
    }
    return error_picture(errors, r.width, r.height);
}

Result<std::string> pictures_json(const AccuracyReport& report) {
    std::string colors, images;
    const auto add = [&](const std::string& name, const ImageBytes& image) -> Status {
        const Result<std::string> url = png_data_url(image);
        if (!url) return url.error();
        images += (images.empty() ? "" : ",") + std::string("{\"name\":") + json_string(name) +
                  ",\"url\":" + json_string(*url) + "}";
        return Done{};
    };
    const std::vector<SweepResult>& results = report.outcome.results;
    for (std::size_t i = 0; i < results.size(); ++i) {
        char color[16];
        std::snprintf(color, sizeof(color), "\"#%06x\"", curve_color(i));
        colors += (i == 0 ? "" : ",") + std::string(color);
    }
    // The best first, against its own first sample; then the others and where the error is.
    for (std::size_t i = 0; i < results.size(); ++i) {
        const std::string label = results[i].config.label();
        if (Status s = add(label, develop(results[i].image, report.display)); !s) return s.error();
        if (i > 0) continue;
        if (Status s =
                add(label + ", first sample", develop(results[i].first_image, report.display));
            !s)
            return s.error();
        if (Status s = add(label + ", error map", block_map(results[i])); !s) return s.error();
    }
    return "{\"colors\":[" + colors + "],\"images\":[" + images + "]}";
}

}  // namespace

Result<std::string> report_html(const AccuracyReport& report) {
    const Result<std::string> pictures = pictures_json(report);
    if (!pictures) return pictures.error();
    char target[32];
    std::snprintf(target, sizeof(target), "%.3g", report.outcome.target_percent);
    std::string html =
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>Accuracy of ";
    html +=
        escape_html(report.scene_file) + "</title><style>" + kStyle + "</style></head><body><h1>";
    html += "What accuracy costs: " + escape_html(report.scene_file) + "</h1>";
    html += "<h2>Advice</h2><p>" + escape_html(report.advice) + "</p>";
    html += "<pre id=\"command\">" + escape_html(report.advice_command) + "</pre>";
    html += "<button id=\"copy\">Copy</button>";
    html += "<h2>Configurations by seconds to " + std::string(target) + " %</h2>";
    html +=
        "<table id=\"table\"><thead><tr><th>configuration</th><th>to the target</th>"
        "<th>error at the end</th><th>after</th><th>exponent</th><th>bias floor</th>"
        "<th>trust</th><th>Pareto</th></tr></thead><tbody></tbody></table>";
    html +=
        "<h2>Relative error against seconds, with 95 % bands</h2>"
        "<svg id=\"curves\" viewBox=\"0 0 1000 520\" width=\"100%\"></svg><div id=\"tip\"></div>";
    html +=
        "<table id=\"why\" hidden><thead><tr><th>what the error is made of</th><th>error</th>"
        "<th>light</th><th>help</th></tr></thead><tbody></tbody></table>";
    html +=
        "<h2>Pictures</h2><p><select id=\"a\"></select> | <select id=\"b\"></select> "
        "<input id=\"range\" type=\"range\" min=\"0\" max=\"100\" value=\"50\" "
        "style=\"width:20em\"></p>";
    html +=
        "<div class=\"wipe\"><img id=\"right\" alt=\"\"><div class=\"over\">"
        "<img id=\"left\" alt=\"\"></div></div>";
    html += "<p>Error map: relative error of blocks of 8x8 pixels, black 0.1 %, white 100 %.</p>";
    html += "<script type=\"application/json\" id=\"data\">" + embed(report_json(report));
    html += "</script><script type=\"application/json\" id=\"pictures\">" + embed(*pictures);
    html += "</script><script>" + std::string(kScript) + "</script></body></html>\n";
    return html;
}

}  // namespace talbot
