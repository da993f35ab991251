// Opens the HTML report of `talbot accuracy` in headless Chromium through playwright-core: moves the wipe, points at a value,
// and reports what it saw as one line of JSON. Usage: node report_browser.mjs REPORT.html CHROMIUM SCREENSHOT.png
import {createRequire} from 'node:module';
import path from 'node:path';
import process from 'node:process';
import {pathToFileURL} from 'node:url';

const [report, browserFile, screenshot] = process.argv.slice(2);
const require = createRequire(path.join(process.env.TALBOT_NODE_MODULES || process.cwd(), 'package.json'));
const {chromium} = require('playwright-core');
const browser = await chromium.launch({executablePath: browserFile, args: ['--no-sandbox']});
const page = await browser.newPage({viewport: {width: 1200, height: 1500}});
const seen = {faults: [], requests: []};
page.on('console', message => { if (message.type() === 'error') seen.faults.push(message.text()); });
page.on('pageerror', error => seen.faults.push(String(error)));
page.on('request', request => {
    const url = request.url();
    if (!url.startsWith('data:') && url !== pathToFileURL(report).href) seen.requests.push(url);
});
await page.goto(pathToFileURL(report).href);
await page.waitForFunction(() => document.getElementById('left').naturalWidth > 0);
const wipe = () => page.locator('.wipe .over').evaluate(e => e.getBoundingClientRect().width);
const picture = () => page.locator('.wipe').evaluate(e => e.getBoundingClientRect().width);
seen.before = await wipe();
// The slider is dragged with the mouse, from its middle to a fifth of its width.
await page.locator('#range').scrollIntoViewIfNeeded();
const slider = await page.locator('#range').boundingBox();
await page.mouse.move(slider.x + slider.width / 2, slider.y + slider.height / 2);
await page.mouse.down();
await page.mouse.move(slider.x + slider.width / 5, slider.y + slider.height / 2, {steps: 5});
await page.mouse.up();
seen.after = await wipe();
seen.picture = await picture();
seen.value = Number(await page.locator('#range').inputValue());
const points = page.locator('circle.point');
seen.points = await points.count();
await points.last().scrollIntoViewIfNeeded();
await points.last().hover({force: true});
seen.tip = await page.locator('#tip').textContent();
seen.tipShown = await page.locator('#tip').isVisible();
await page.locator('#a').selectOption({index: 2});
await page.waitForTimeout(100);
seen.chosen = await page.locator('#left').evaluate(e => e.src.slice(0, 22));
seen.rows = await page.locator('#table tbody tr').count();
seen.why = await page.locator('#why tbody tr').count();
if (screenshot) await page.screenshot({path: screenshot, fullPage: true});
await browser.close();
console.log(JSON.stringify(seen));
