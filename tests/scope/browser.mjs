// Starts Debian's Chromium without a screen. CHROMIUM names another one.
import {createRequire} from 'node:module';

const {chromium} = createRequire(import.meta.url)('playwright-core');  // found by NODE_PATH, too

export async function browser() {
  const started = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--disable-gpu', '--disable-dev-shm-usage', '--hide-scrollbars'],
  });
  return started;
}

/** Opens a tab with the page, and collects its errors. */
export async function open(started, url, options = {}) {
  const context = await started.newContext({viewport: {width: 1280, height: 720}, acceptDownloads: true, ...options});
  const page = await context.newPage();
  page.faults = [];
  page.on('pageerror', (error) => page.faults.push(String(error)));
  page.on('console', (message) => { if (message.type() === 'error') { page.faults.push(message.text()); } });
  page.setDefaultTimeout(120000);
  await page.goto(url);
  return page;
}
