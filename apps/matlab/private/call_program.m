function [text, messages, status] = call_program(words, known, folder)
%CALL_PROGRAM  Runs `hertzline` with these words, and returns its standard output.
%   messages.faults is its text of errors, messages.warnings a cell of its warnings. Names of options in them are those of
%   KNOWN (see option_words). FOLDER is the scratch folder. An exit status above 0 is an error; with three outputs
%   only wrong use is one, and the caller judges the rest.
program = getenv('HERTZLINE');
if isempty(program)
    program = 'hertzline';
end
out = fullfile(folder, 'stdout');
err = fullfile(folder, 'stderr');
quoted_words = cellfun(@quoted, [{program}, words], 'UniformOutput', false);
command = sprintf('%s ', quoted_words{:}, '</dev/null', ['>' quoted(out)], ['2>' quoted(err)]);
if ~exist('OCTAVE_VERSION', 'builtin')
    command = ['unset LD_LIBRARY_PATH; ' command];  % MATLAB's own libraries are not those of the program
end
[status, said] = system(['/bin/sh -c ' quoted(command)]);  % the user's own shell may know other redirections
if any(status == [126 127])
    error('hertzline:notFound', ['%s: found no such program, allowed: hertzline on the PATH, or its file in the environment ' ...
                                 'variable HERTZLINE\n%s'], program, strtrim([said, read_text(err)]));
end
text = read_text(out);
messages = sorted(strsplit(read_text(err), sprintf('\n')), known, folder);
if status ~= 0 && isempty(messages.faults)
    messages.faults = sprintf('%s ended with status %d', program, status);
end
if status == 2
    error('hertzline:wrongUse', '%s', messages.faults);
elseif status ~= 0 && nargout < 3
    error('hertzline:failed', '%s', messages.faults);
end
end

function word = quoted(word)
% A word as the shell takes it literally.
word = ['''' strrep(word, '''', '''\''''') ''''];
end

function messages = sorted(lines, known, folder)
% Lines with another beginning continue the one before.
faults = {};
messages.warnings = cell(0, 1);
kind = '';
for k = 1:numel(lines)
    parts = regexp(lines{k}, '^(error|warning|info): (.*)$', 'tokens', 'once');
    line = lines{k};
    if ~isempty(parts)
        kind = parts{1};
        line = parts{2};
    end
    if strcmp(kind, 'error') && ~isempty(line)
        faults{end + 1} = translated(line, known, folder); %#ok<AGROW>
    elseif strcmp(kind, 'warning') && ~isempty(line)
        messages.warnings{end + 1, 1} = translated(line, known, folder);
    end
end
messages.faults = strjoin(faults, sprintf('\n'));
end

function text = translated(text, known, folder)
text = strrep(text, [folder filesep], '');
text = strrep(strrep(text, '--set ', ''), '--vary ', 'vary ');
for k = 1:size(known, 1)
    if ~isempty(known{k, 2})
        text = strrep(text, known{k, 2}, known{k, 1});
    end
end
end
