function write_text(file, text)
%WRITE_TEXT  Writes a file in UTF-8.
handle = fopen(file, 'w');
if handle < 0
    error('hertzline:failed', '%s: cannot be written', file);
end
fwrite(handle, unicode2native(text, 'UTF-8'), 'uint8');
fclose(handle);
end
