function block = hertzline_listen(endpoint, samples, varargin)
%HERTZLINE_LISTEN  Receive samples of a running stream.
%   b = HERTZLINE_LISTEN(endpoint, samples) waits for the stream at ENDPOINT, by default 'tcp://127.0.0.1:5573', and receives
%   SAMPLES of them; all until the run ends where SAMPLES is [] or left out. `hertzline stream paper-stream` is such a stream.
%
%   b = HERTZLINE_LISTEN(endpoint, samples, OPTION, VALUE, ...) with these options:
%     'stream'     its name; by default 'v_out'
%     'gaps'       'raise' an error where samples are missing, which is the default, or 'mark' them in `gaps`
%     'timeout_s'  the longest wait for a message [s]; by default without limit for the first samples, then 15 s
%     'curve_key', 'server_key'  files of keys, for an encrypted stream: one's own secret key, the stream's public key
%
%   The result b has these fields:
%     v_out_m_per_s, ...  the samples under the name of the stream and its unit, single: [sample x 1], [sample x sphere] of
%                         v_chain, [sample x contact] of f_chain, [sample x element] of an array
%     t_s                 time of each sample since the run's start [s], [sample x 1]
%     sample              number of each sample since the run's start, [sample x 1]
%     gaps                columns [gap x 1]: before_sample is the sample that follows a gap, missing counts those that it lacks
%     missing             count of all missing samples
%     summary             the numbers of `hertzline listen --json`: rate fs [Hz], id of the run, frames, losses and their side
%     provenance          version, scene, integrator, step and estimated error of the stream
%     warnings            a cell of sentences
%
%   Errors: 'hertzline:gap' where samples are missing; 'hertzline:failed' where a stream is silent, refuses or breaks off;
%   'hertzline:wrongUse' names every wrong argument; 'hertzline:notFound'.
%
%   Example: a millisecond of a stream
%     b = hertzline_listen('tcp://127.0.0.1:5573', 10000, 'stream', 'v_last');
%     plot(b.t_s, b.v_last_m_per_s)
%
%   See also HERTZLINE_RUN.

known = {'stream', '--stream', 'one'
         'timeout_s', '--timeout', 'one'
         'curve_key', '--curve-key', 'one'
         'server_key', '--server-key', 'one'
         'gaps', '', 'none'
         'samples', '--samples', 'one'
         'endpoint', '--connect', 'one'};
if nargin > 0 && ~isempty(endpoint)
    varargin = [varargin, {'endpoint', endpoint}];
end
if nargin > 1 && ~isempty(samples)
    varargin = [varargin, {'samples', samples}];
end
[folder, cleanup] = scratch_folder(); %#ok<ASGLU>
[words, options] = option_words('hertzline_listen', known, varargin, folder);
gaps = 'raise';
if isfield(options, 'gaps')
    gaps = char(options.gaps);
end
if ~any(strcmp(gaps, {'raise', 'mark'}))
    error('hertzline:wrongUse', 'gaps: found "%s", allowed: "raise", "mark"', gaps);
end
file = fullfile(folder, 'heard.npy');
[text, messages, status] = call_program([{'listen', '--json', '--output', file}, words], known, folder);
if status ~= 0
    judge(text, messages, gaps);
end

[block, about] = read_npy(file);
block.sample = round(block.t_s * about.sample_rate_hz);
steps = diff(block.sample);
after = find(steps ~= 1);
block.gaps = struct('before_sample', reshape(block.sample(after + 1), [], 1), 'missing', reshape(steps(after) - 1, [], 1));
block.summary = rmfield(decode_json(text), 'recordings');
block.missing = block.summary.missing_samples;
block.provenance = about.provenance;
block.warnings = messages.warnings;
end

function judge(text, messages, gaps)
% Raises the error of a stream that was not received to its end and whole; returns where only samples are missing and are marked.
if isempty(text)
    error('hertzline:failed', '%s', messages.faults);
end
summary = decode_json(text);
recorded = isstruct(summary.recordings) && all(strcmp({summary.recordings.status}, 'complete'));
heard_out = any(strcmp(summary.ended_by, {'end of run', 'duration', 'stopped'}));
if ~recorded || ~heard_out || summary.missing_samples == 0
    error('hertzline:failed', '%s', strjoin([messages.warnings; {messages.faults}], sprintf('\n')));
end
if strcmp(gaps, 'raise')
    error('hertzline:gap', '%d samples are missing\n%s', summary.missing_samples, messages.faults);
end
end
